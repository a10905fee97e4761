// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/consistency.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/result_writer.hpp"
#include "experiments/judging/error_convention.hpp"
#include "experiments/judging/run_files.hpp"
#include "experiments/judging/state_rows.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// How estimates of another program become a result file.
struct JudgingOptions {
  std::filesystem::path output;
  ErrorConvention convention = ErrorConvention::world;
  TimeMatch match;
  Existing existing = Existing::refuse;
  TextPairs provenance;
  double level = 0.95;                     ///< of the hints
  double within = analysis::kUsualMargin;  ///< likewise
};

/// What the estimates of a cell would be by each convention that their state has.
struct ConventionHint {
  std::string cell;
  struct Judged {
    ErrorConvention convention;
    analysis::Consistency consistency;
  };
  std::vector<Judged> by_convention;
};

/// Reads estimates and truths run by run, and writes their errors as a result file that every
/// reader of a study reads. Nothing is aligned. Memory does not grow with the runs but for one
/// number each. Throws StudyError naming file, line and remedy, and leaves no file then.
std::vector<ConventionHint> judge_files(const JudgedFiles& files, const JudgingOptions& options);

}  // namespace montecarta::experiments
