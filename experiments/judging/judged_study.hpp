// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/result_writer.hpp"
#include "experiments/judging/error_convention.hpp"
#include "experiments/judging/run_files.hpp"
#include "experiments/judging/state_columns.hpp"

#include <filesystem>
#include <optional>
#include <string_view>

namespace montecarta::experiments {

/// How estimates of another program become a result file.
struct JudgingOptions {
  std::filesystem::path output;
  /// nullopt: nothing is said, which is enough for a state of one convention.
  std::optional<ErrorConvention> convention = {};
  TimeMatch match;
  Existing existing = Existing::refuse;
  TextPairs provenance;
  std::optional<double> within;  ///< stored as what counts as consistent; nothing where not given
};

/// Reads estimates and truths run by run, and writes their errors as a result file that every
/// reader of a study reads. Nothing is aligned. Memory does not grow with the runs. Throws
/// StudyError naming file, line and remedy, and leaves no file then.
void judge_files(const JudgedFiles& files, const JudgingOptions& options);

/// How the text of an imported study begins, that no study file does.
inline constexpr std::string_view kImportedSection = "[imported]";

/// A plan by which a result file of these estimates is laid out: nothing can run it. `first`: the
/// estimates whose state and times all have. Its text names the contents of all files by their
/// SHA-256, so that two results of the same estimates, judged alike, agree in study_sha256.
StudyPlan imported_plan(const JudgedFiles& files, const StateRows& first,
                        const JudgingOptions& options);

}  // namespace montecarta::experiments
