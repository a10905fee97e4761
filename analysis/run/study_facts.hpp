// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/judgement.hpp"
#include "engine/records/result_file.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// How a study wants to be judged, as the section [study] of its resolved text says.
struct StudyFacts {
  double within = kUsualMargin;  ///< margin of consistent ratios
  double judge_from = 0.0;       ///< [s] scans before this time are not judged
  bool stops_early = false;      ///< whether cells may end before all runs are made
  /// {interim analysis} Numbers of runs, if cells stop by verdict; else empty: there is one
  /// analysis, after all runs.
  std::vector<std::uint64_t> runs_at_analyses = {};
};

/// The facts of a study of `runs` runs. Throws StudyError if study.within is no number from
/// kLeastMargin to kMostMargin, or study.judge_from no time.
StudyFacts study_facts_in(const std::string& study_text, std::uint64_t runs);

/// The facts of the study in the file. Throws StudyError as study_facts_in() does.
StudyFacts study_facts_of(const ResultFile& file);

}  // namespace montecarta::analysis
