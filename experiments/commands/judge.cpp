// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/result_file.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/judging/estimate_arrays.hpp"
#include "experiments/judging/estimate_files.hpp"
#include "experiments/judging/innovation_files.hpp"
#include "experiments/judging/judged_study.hpp"
#include "experiments/judging/run_files.hpp"
#include "experiments/text/words.hpp"

#include <iostream>
#include <memory>
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
  if (const auto names = arguments.text("components")) options.components = split(*names, ',');
  options.existing = arguments.has("force") ? Existing::replace : Existing::refuse;
  options.provenance = provenance_of("judge", arguments);
  options.within = arguments.number("within", kLeastMargin, kMostMargin);
  return options;
}

/// The estimates that the operands name: CSV files with their truths, or one HDF5 file of arrays.
std::unique_ptr<EstimateSource> source_of(const Arguments& arguments,
                                          const JudgingOptions& options) {
  const std::vector<std::string>& operands = arguments.operands();
  const std::vector<std::string> truths = arguments.texts("truth");
  if (operands.size() == 1 && h5::is_hdf5(operands.front())) {
    if (truths.empty()) {
      const std::string stem = std::filesystem::path(operands.front()).stem().string();
      return std::make_unique<EstimateArrays>(operands.front(),
                                              arguments.text("cell").value_or(stem));
    }
    throw StudyError("--truth: not beside " + operands.front() +
                     " (arrays have their truth in the same file): leave it out");
  }
  const std::string ending = std::filesystem::path(operands.front()).extension().string();
  if (!h5::is_hdf5(operands.front()) &&
      (ending == ".h5" || ending == ".hdf5" || ending == ".mat")) {
    throw StudyError(operands.front() + ": is there no such file, or no HDF5 file (arrays are in " +
                     "one): give its name; convert a .mat of version 7 by "
                     "experiments/convert/estimates.py");
  }
  if (operands.size() > 1 && h5::is_hdf5(operands.front())) {
    throw StudyError(operands[1] + ": one file of arrays is judged at a time (it has all runs): " +
                     "judge the files apart");
  }
  if (arguments.has("innovations")) {
    if (truths.empty()) {
      return std::make_unique<InnovationFiles>(pair_files(operands, {}, arguments.text("cell")));
    }
    throw StudyError("--truth: not beside --innovations (innovations need no truth): leave it out");
  }
  if (truths.empty()) {
    throw StudyError(
        "judge: --truth PATH... is missing (an error is estimate minus truth): name "
        "the true states");
  }
  return std::make_unique<EstimateFiles>(pair_files(operands, truths, arguments.text("cell")),
                                         options.match.tolerance, options.equal_times);
}

}  // namespace

int judge_command(const Arguments& arguments) {
  const JudgingOptions options = judging_options(arguments);
  refuse_input_as_output(options.output, arguments.operands());
  const std::unique_ptr<EstimateSource> source = source_of(arguments, options);
  const std::vector<std::string> notes = judge_estimates(*source, options);
  const ResultFile file(options.output);
  print_summary(std::cout, analyze(file, kUsualLevel, parallel_of(arguments)),
                engine::output_width());
  print_where_to_look(options.output.string(), "");
  for (const std::string& note : notes) std::cerr << "montecarta: note: " << note << "\n";
  std::cerr << "montecarta: " << source->runs().size()
            << (source->runs().size() == 1 ? " run of " : " runs of ") << source->cells().size()
            << (source->cells().size() == 1 ? " estimator" : " estimators") << ", stored in "
            << options.output.string() << "\n";
  return kDone;
}

}  // namespace montecarta::experiments
