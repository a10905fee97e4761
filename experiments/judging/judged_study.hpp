// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/result_writer.hpp"
#include "experiments/judging/error_convention.hpp"
#include "experiments/judging/estimate_source.hpp"
#include "experiments/judging/truth_path.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// The settings by which the estimates of another program become a result file.
struct JudgingOptions {
  std::filesystem::path output;
  /// The convention; nullopt if the user gave none, which is allowed for a state that has only one.
  std::optional<ErrorConvention> convention = {};
  TimeMatch match;
  std::vector<std::string> components = {};  ///< names of those that are judged; empty: all
  EqualTimes equal_times = EqualTimes::refuse;
  Existing existing = Existing::refuse;
  TextPairs provenance;
  std::optional<double> within;  ///< margin of consistent ratios; not stored if not given
};

/// Reads estimates and truths run by run, and writes their errors as a result file that can be
/// analysed like that of a study. Trajectories are not aligned. Memory grows with the
/// number of runs by their times alone. Returns notes on contents that are judged as they are, but
/// are likely a mistake. Throws StudyError with file, line and remedy, and then leaves no file.
std::vector<std::string> judge_estimates(const EstimateSource& source,
                                         const JudgingOptions& options);

/// Beginning of the text of an imported study, with which no study file begins.
inline constexpr std::string_view kImportedSection = "[imported]";

}  // namespace montecarta::experiments
