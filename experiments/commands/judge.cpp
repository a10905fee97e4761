// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/judging/judged_study.hpp"
#include "experiments/text/words.hpp"

#include <iostream>
#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

/// The convention given by --error; nullopt if the option was not given, which is allowed for a
/// state that has only one.
std::optional<ErrorConvention> convention_of(const Arguments& arguments) {
  const auto said = arguments.text("error");
  for (const ErrorConvention convention : conventions_of(StateKind::pose)) {
    if (said == name_of(convention)) return convention;
  }
  return std::nullopt;
}

/// The choice among rows of one time by --keep.
EqualTimes equal_times_of(const Arguments& arguments) {
  const auto said = arguments.text("keep");
  if (!said) return EqualTimes::refuse;
  return *said == "first" ? EqualTimes::keep_first : EqualTimes::keep_last;
}

JudgingOptions judging_options(const Arguments& arguments) {
  JudgingOptions options;
  options.output = arguments.text("output").value();
  require_place_for_result(options.output);
  options.convention = convention_of(arguments);
  options.match.tolerance =
      arguments.number("tolerance", 0.0, 1e6).value_or(options.match.tolerance);
  options.match.interpolate = arguments.has("interpolate");
  options.match.longest_gap = arguments.number("longest-gap", 0.0, 1e9);
  options.equal_times = equal_times_of(arguments);
  options.existing = arguments.has("force") ? Existing::replace : Existing::refuse;
  options.provenance = provenance_of("judge", arguments);
  options.within = arguments.number("within", kLeastMargin, kMostMargin);
  return options;
}

}  // namespace

int judge_command(const Arguments& arguments) {
  const JudgingOptions options = judging_options(arguments);
  const JudgedFiles files =
      pair_files(arguments.operands(), arguments.texts("truth"), arguments.text("cell"));
  const std::vector<std::string> notes = judge_files(files, options);
  const ResultFile file(options.output);
  print_summary(std::cout, analyze(file, kUsualLevel, parallel_of(arguments)),
                engine::output_width());
  print_where_to_look(options.output.string(), "");
  for (const std::string& note : notes) std::cerr << "montecarta: note: " << note << "\n";
  std::cerr << "montecarta: " << files.runs.size()
            << (files.runs.size() == 1 ? " run of " : " runs of ") << files.cells.size()
            << (files.cells.size() == 1 ? " estimator" : " estimators") << ", stored in "
            << options.output.string() << "\n";
  return kDone;
}

}  // namespace montecarta::experiments
