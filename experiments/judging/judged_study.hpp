// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/estimate_source.hpp"
#include "experiments/judging/judging_options.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {

/// Reads estimates and truths run by run, and writes their errors as a result file that can be
/// analysed like that of a study. Trajectories are not aligned. Memory grows with the
/// number of runs by their times alone. Returns notes on contents that are judged as they are, but
/// are likely a mistake. Throws StudyError with file, line and remedy, and then leaves no file.
std::vector<std::string> judge_estimates(const EstimateSource& source,
                                         const JudgingOptions& options);

}  // namespace montecarta::experiments
