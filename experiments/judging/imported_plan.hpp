// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "experiments/judging/judged_study.hpp"

#include <string>
#include <string_view>

namespace montecarta::experiments {

/// How the text of an imported study begins, that no study file does.
inline constexpr std::string_view kImportedSection = "[imported]";

/// A plan by which a result file of these estimates is laid out: nothing can run it. `first`: the
/// estimates whose state and times all have. Its text names the contents of all files by their
/// SHA-256, so that two results of the same estimates, judged alike, agree in study_sha256.
StudyPlan imported_plan(const JudgedFiles& files, const StateRows& first,
                        const JudgingOptions& options);

}  // namespace montecarta::experiments
