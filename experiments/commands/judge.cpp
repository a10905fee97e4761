// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/study_settings.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/tables/tables.hpp"
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "engine/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_guard.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/judging/judged_study.hpp"
#include "experiments/text/words.hpp"

#include <iostream>

namespace montecarta::experiments {
namespace {

/// The convention given by --error; nullopt if the option was not given, which is allowed for a
/// state that has only one.
std::optional<ErrorConvention> convention_of(const Arguments& arguments) {
  const auto said = arguments.text("error");
  std::vector<std::string> known;
  for (const ErrorConvention convention : conventions_of(StateKind::pose)) {
    if (said == name_of(convention)) return convention;
    known.push_back(name_of(convention));
  }
  if (said) {
    throw StudyError("--error " + *said + ": not known (one of " + joined(known) +
                     "): " + nearest_spelling(*said, known));
  }
  return std::nullopt;
}

JudgingOptions judging_options(const Arguments& arguments) {
  const auto output = arguments.text("output");
  if (!output) {
    throw StudyError(
        "judge: -o OUT.h5 is missing (the judged errors need a name): add e.g. -o "
        "mine.h5");
  }
  expect_place_for_result(*output);
  JudgingOptions options;
  options.output = *output;
  options.convention = convention_of(arguments);
  options.match.tolerance =
      arguments.number("tolerance", 0.0, 1e6).value_or(options.match.tolerance);
  options.match.interpolate = arguments.has("interpolate");
  options.existing = arguments.has("force") ? Existing::replace : Existing::refuse;
  options.provenance = provenance_of("judge", arguments);
  options.within = arguments.number("within", kLeastMargin, kMostMargin);
  return options;
}

int judge_estimates(const Arguments& arguments) {
  const JudgingOptions options = judging_options(arguments);
  const std::vector<std::string> truths = arguments.texts("truth");
  if (truths.empty()) {
    throw StudyError(
        "judge: --truth is missing (estimates are judged by the true states): add "
        "--truth with the files, or with a folder of 'montecarta export'");
  }
  const JudgedFiles files = pair_files(arguments.operands(), truths, arguments.text("cell"));
  judge_files(files, options);
  const ResultFile file(options.output);
  print_summary(std::cout, analyze(file, 0.95, parallel_of(arguments)), engine::output_width());
  print_where_to_look(options.output.string(), "");
  std::cerr << "montecarta: " << files.runs.size() << " runs of " << files.cells.size()
            << (files.cells.size() == 1 ? " estimator" : " estimators") << ", stored in "
            << options.output.string() << "\n";
  return kDone;
}

}  // namespace

Command judge_command() {
  return {
      {.name = "judge",
       .summary = "Judge the estimates of another program, read from CSV files",
       .operands = {{"ESTIMATE.csv", 1, SIZE_MAX}},
       .options =
           {{"truth", "", {"PATH..."}, "true states, or a folder of montecarta export", true, true},
            {"error",
             "",
             {"world|body|right-invariant"},
             "error of the covariance; needed for poses"},
            {"output", "o", {"OUT.h5"}, "result file"},
            {"cell", "", {"NAME"}, "name of the estimator, if there is only one"},
            {"tolerance", "", {"SECONDS"}, "tolerance of equal times; default 1e-6"},
            {"interpolate", "", {}, "interpolate the truth between its rows"},
            {"within", "", {"R"}, kWithinMeaning},
            {"force", "", {}, "replace OUT.h5"},
            {"threads", "", {"N"}, kThreadsMeaning},
            {"backend", "", {"tbb|openmp|serial"}, kBackendMeaning}},
       .details =
           "The columns of an estimate are time_s, then x_m,y_m,heading_rad or "
           "x_m,y_m,z_m,qx,qy,qz,qw or any other state, then cov_A_B, where A and B are components "
           "or indices from 0, for the whole covariance or one triangle. Innovations are optional: "
           "the columns nis,nis_dof, or innovation.csv beside estimate.csv. Truths have no "
           "covariance. Trajectories are not aligned. "
           "experiments/convert/trajectory.py converts trajectories of TUM and "
           "OpenVINS.\n\n--error names the error that the covariance describes:\n" +
           explained_conventions() + "\n" + pairing_rule() +
           "\nexample:\n  montecarta judge runs/*/estimate.csv --truth runs/*/truth.csv \\\n      "
           "--error world -o mine.h5\n"},
      judge_estimates};
}

}  // namespace montecarta::experiments
