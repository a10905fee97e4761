// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/result_file.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/judging/estimate_arrays.hpp"
#include "experiments/judging/estimate_files.hpp"
#include "experiments/judging/increments.hpp"
#include "experiments/judging/innovation_files.hpp"
#include "experiments/judging/judged_study.hpp"
#include "experiments/judging/run_files.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::experiments {
namespace {

/// The convention given by --error; nullopt if the option was not given, which is allowed for a
/// state that has only one.
std::optional<ErrorConvention> convention_of(const Arguments& arguments) {
  const auto said = arguments.text("error");
  for (const ErrorConvention convention : conventions_of(StateKind::pose_in_space)) {
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

/// The increasing lengths [s] in a list with commas.
std::vector<double> windows_in(const std::string& list) {
  std::vector<double> windows;
  for (const std::string& text : split(list, ',')) {
    const auto window = to_number(text);
    if (!window || !(*window > 0.0) || (!windows.empty() && *window <= windows.back())) {
      throw StudyError("--windows {}: not a list of increasing lengths in s: write e.g. 1,10,60",
                       excerpt(list));
    }
    windows.push_back(*window);
  }
  return windows;
}

JudgingOptions judging_options(const Arguments& arguments) {
  JudgingOptions options;
  options.output = arguments.text("output").value();
  require_place_for_result(options.output);
  options.convention = convention_of(arguments);
  options.match.tolerance =
      arguments.number("tolerance", 0.0, 1e6).value_or(options.match.tolerance);
  options.match.longest_gap = arguments.number("longest-gap", 0.0, 1e9);
  options.match.interpolate = arguments.has("interpolate") || options.match.longest_gap;
  options.equal_times = equal_times_of(arguments);
  if (const auto name = arguments.text("anchor")) options.anchor = anchor_named(*name);
  options.adds_truth_covariance = arguments.has("truth-cov");
  if (const auto gates = arguments.text("gate")) options.gates.emplace(*gates);
  if (const auto windows = arguments.text("windows")) options.windows = windows_in(*windows);
  options.are_innovations = arguments.has("innovations");
  if (const auto names = arguments.text("components")) options.components = split(*names, ',');
  options.existing = arguments.has("force") ? Existing::replace : Existing::refuse;
  options.provenance = provenance_of("judge", arguments);
  options.within = arguments.number("within", kLeastMargin, kMostMargin);
  return options;
}

/// The part of the files of estimates that replaces a truth, if none is named.
OwnTruth own_truth_of(const std::string& estimates, const std::vector<std::string>& truths) {
  const CsvRows file(estimates);
  const OwnTruth found = own_truth_in(file.columns(), file.place());
  if (truths.empty() && found == OwnTruth::none) {
    throw StudyError(
        "judge: --truth PATH... is missing (an error is estimate minus truth): name "
        "the true states, give the estimates columns true_x_m, ... beside x_m, ..., "
        "or columns error_x_m, ... instead of them; if these are innovations, say --innovations");
  }
  if (truths.empty() || found == OwnTruth::none) return found;
  throw StudyError("--truth: not beside {} (its columns begin with {}: it {}): leave it out",
                   estimates, found == OwnTruth::columns ? kTruthPrefix : kErrorPrefix,
                   found == OwnTruth::columns ? "has a truth" : "needs none");
}

/// Throws StudyError if one of these options was given, which do not apply to `what`.
void refuse_options(const Arguments& arguments, std::span<const std::string_view> options,
                    const std::string& what) {
  for (const std::string_view option : options) {
    if (!arguments.has(std::string(option))) continue;
    throw StudyError("--{}: not beside {}: leave it out", option, what);
  }
}

/// Throws StudyError if an operand is a number that was meant as the value of --interpolate.
void refuse_number_as_file(const std::vector<std::string>& operands) {
  for (const std::string& operand : operands) {
    if (!to_number(operand) || std::filesystem::exists(operand)) continue;
    throw StudyError(
        "{}: there is no such file (--interpolate takes no number): if it is the longest gap of "
        "the truth in s, give it by --longest-gap {}",
        operand, operand);
  }
}

/// The arrays in an HDF5 file, or in one of NumPy or MATLAB.
std::unique_ptr<EstimateSource> arrays_of(const Arguments& arguments) {
  const std::vector<std::string>& operands = arguments.operands();
  if (operands.size() > 1) {
    throw StudyError(
        "{}: one file of arrays is judged at a time (it has all runs): judge the files apart",
        operands[1]);
  }
  constexpr std::array<std::string_view, 8> kOfFiles = {
      "truth", "keep", "pair", "truth-cov", "innovations", "gate", "interpolate", "longest-gap"};
  refuse_options(arguments, kOfFiles,
                 operands.front() + " (arrays have all of their numbers in the file)");
  const std::string stem = std::filesystem::path(operands.front()).stem().string();
  auto arrays = std::make_unique<EstimateArrays>(
      operands.front(), arguments.text("cell").value_or(stem), arguments.text("names"));
  constexpr std::array<std::string_view, 2> kOfStates = {"error", "anchor"};
  if (arrays->has_errors()) {
    refuse_options(arguments, kOfStates, operands.front() + " (it has errors, and no states)");
  }
  return arrays;
}

std::unique_ptr<EstimateSource> innovations_of(const Arguments& arguments,
                                               const JudgingOptions& options) {
  constexpr std::array<std::string_view, 10> kOfStates = {
      "truth",       "error",       "pair",       "anchor", "truth-cov",
      "interpolate", "longest-gap", "components", "keep",   "tolerance"};
  refuse_options(arguments, kOfStates, "--innovations (innovations need no truth and no state)");
  return std::make_unique<InnovationFiles>(
      pair_files(arguments.operands(), {}, arguments.text("cell")), options.gates);
}

/// The files of two estimators, the second of which is in place of the truth. Fills `pair`.
std::unique_ptr<EstimateSource> pair_of(const Arguments& arguments,
                                        const EstimateFiles::Reading& how, std::string& pair) {
  constexpr std::array<std::string_view, 4> kOfTruths = {"truth", "truth-cov", "anchor", "cell"};
  refuse_options(arguments, kOfTruths, "--pair (an estimator is in place of the truth)");
  JudgedFiles files = files_of_pair(arguments.operands());
  if (files.cells.size() != 2) {
    throw StudyError(
        "--pair: needs two estimators ({}{} found): name the files of both, one of each or all "
        "runs of each",
        files.cells.size(), files.cells.size() == 1 ? " was" : " were");
  }
  EstimatorFiles& first = files.cells.front();
  pair = formatted("{} and {}", first.cell, files.cells.back().cell);
  first.cell += "-" + files.cells.back().cell;
  check_label(first.cell);
  files.truth = std::move(files.cells.back().of_run);
  files.cells.pop_back();
  return std::make_unique<EstimateFiles>(std::move(files), how);
}

/// Throws StudyError if a file is called like arrays, but is none that can be read.
void refuse_other_arrays(const std::string& path) {
  const std::string ending = extension_of(path);
  if (ending == ".npy") {
    throw StudyError(
        "{}: a NumPy array alone (errors and covariances are read from one file): write both by "
        "numpy.savez(\"a.npz\", error=errors, covariance=covariances), or call "
        "montecarta.judge(errors, covariances) in Python",
        path);
  }
  if (ending == ".h5" || ending == ".hdf5") {
    throw StudyError(
        "{}: is there no such file, or no HDF5 file (arrays are in one): give its name, or call "
        "montecarta.judge from Python",
        path);
  }
}

/// The estimates that the operands name: CSV files, or one file of arrays.
std::unique_ptr<EstimateSource> source_of(const Arguments& arguments, JudgingOptions& options) {
  const std::vector<std::string>& operands = arguments.operands();
  if (h5::is_hdf5(operands.front()) || are_foreign_arrays(operands.front()))
    return arrays_of(arguments);
  refuse_other_arrays(operands.front());
  if (arguments.has("names")) {
    throw StudyError("--names: needs a file of arrays (a CSV file has a header): leave it out");
  }
  if (arguments.has("innovations")) return innovations_of(arguments, options);
  if (options.gates) {
    throw StudyError(
        "--gate: needs --innovations (a gate is judged by each of them): leave it out");
  }
  EstimateFiles::Reading how{.tolerance = options.match.tolerance,
                             .equal_times = options.equal_times,
                             .truth_covariance = true};
  if (arguments.has("pair")) {
    how.is_pair = options.match.is_pair = true;
    return pair_of(arguments, how, options.pair);
  }
  const std::vector<std::string> truths = arguments.texts("truth");
  how.own_truth = own_truth_of(operands.front(), truths);
  if (how.own_truth == OwnTruth::errors) {
    constexpr std::array<std::string_view, 4> kOfTruths = {"error", "anchor", "truth-cov",
                                                           "windows"};
    refuse_options(arguments, kOfTruths, operands.front() + " (it has errors, and no states)");
  }
  if (options.anchor && options.adds_truth_covariance) {
    throw StudyError(
        "--truth-cov: not beside --anchor (the truth's error at the anchor would be in "
        "every row): leave one of them out");
  }
  how.truth_covariance = options.adds_truth_covariance;
  return std::make_unique<EstimateFiles>(pair_files(operands, truths, arguments.text("cell")), how);
}

}  // namespace

int judge_command(const Arguments& arguments) {
  JudgingOptions options = judging_options(arguments);
  refuse_input_as_output(options.output, arguments.operands());
  if (options.match.interpolate) refuse_number_as_file(arguments.operands());
  std::unique_ptr<EstimateSource> source = source_of(arguments, options);
  if (!options.windows.empty()) {
    constexpr std::array<std::string_view, 4> kOfWhole = {"anchor", "pair", "truth-cov",
                                                          "innovations"};
    refuse_options(arguments, kOfWhole, "--windows (it judges increments of poses by their truth)");
    auto increments = std::make_unique<Increments>(std::move(source), options);
    options.bounds_increments = increments->are_bounded();
    source = std::move(increments);
  }
  const std::vector<std::string> notes = judge_estimates(*source, options);
  const ResultFile file(options.output);
  print_summary(std::cout, analyze(file, kUsualLevel, parallel_of(arguments)),
                engine::output_width());
  print_where_to_look(options.output.string(), "");
  for (const std::string& note : notes) std::cerr << "montecarta: note: " << note << "\n";
  std::cerr << "montecarta: " << source->runs().size()
            << (source->runs().size() == 1 ? " run of " : " runs of ") << source->cells().size()
            << (options.are_innovations ? " cell" : " estimator")
            << (source->cells().size() == 1 ? ", stored in " : "s, stored in ")
            << options.output.string() << "\n";
  return kDone;
}

}  // namespace montecarta::experiments
