// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "experiments/judging/estimate_source.hpp"
#include "experiments/judging/judging_options.hpp"
#include "experiments/judging/state_rows.hpp"

#include <Eigen/Core>

#include <string>
#include <string_view>
#include <vector>

namespace montecarta::experiments {

/// Beginning of the text of an imported study, with which no study file begins.
inline constexpr std::string_view kImportedSection = "[imported]";

/// Indices of the components that are judged: those of `wanted`, or all. Throws StudyError with the
/// known names if there is no such component.
std::vector<Eigen::Index> judged_components(const StateShape& shape,
                                            const std::vector<std::string>& wanted);

/// The plan that defines the layout of the result file; it cannot be run. The text of the plan
/// contains the SHA-256 of all estimates, so that results of the same estimates, judged with the
/// same options, have the same study_sha256. `first` has the state and the innovations of all;
/// `times` [s] are those of the scans.
StudyPlan imported_plan(const EstimateSource& source, const StateRows& first,
                        std::vector<double> times, const JudgingOptions& options);

}  // namespace montecarta::experiments
