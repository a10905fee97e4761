// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/figures/gnuplot.hpp"
#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/tuning.hpp"
#include "analysis/verdict/sentence.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/text/visible_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/files/passing_folder.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/text/words.hpp"
#include "experiments/tuning/noise_confirmation.hpp"
#include "experiments/tuning/noise_search.hpp"
#include "experiments/tuning/reference_half.hpp"

#include <filesystem>
#include <iostream>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kConfirmationFile = "confirmation.h5";

/// Throws StudyError if a result is given in place of a study.
void refuse_result(const std::string& name) {
  if (fs::path(name).extension() != ".h5") return;
  throw StudyError(name +
                   ": a result, not a study (the filter is run again with other noise, and "
                   "estimates of another program cannot be): give the study, which 'montecarta "
                   "info FILE.h5 --text' prints");
}

const CellSpec& cell_to_tune(const Study& study, const Arguments& arguments) {
  const auto label = arguments.text("cell");
  const CellSpec& cell =
      !label && study.cells.size() == 1
          ? study.cells.front()
          : item_called(label.value_or(""), study.cells, &CellSpec::label,
                        label ? formatted("--cell {}: no cell of this study", *label)
                              : std::string("tune: --cell CELL is needed (one filter is tuned)"));
  if (!starts_program(*cell.filter)) return cell;
  throw StudyError(
      "{}: cell {} is a program (it would be started hundreds of times, and need not use the noise "
      "of [belief]): tune a filter of this program, or vary the noise of yours with "
      "motion_noise=0.5,1,2 in the study",
      cell.place, cell.label);
}

/// Seed of the confirming runs: --seed, or the one after that of the study.
std::uint64_t seed_to_confirm(const Study& study, const Arguments& arguments) {
  const std::uint64_t trained = study.settings.count("study", "seed");
  const std::uint64_t seed =
      arguments.count("seed", 0, UINT64_MAX).value_or(trained == UINT64_MAX ? 0 : trained + 1);
  if (seed != trained) return seed;
  throw StudyError(
      "--seed {}: the seed of the study (its runs choose the factors, and cannot confirm them): "
      "give another one",
      seed);
}

/// Returns the score that --by names, or else that of the best knowledge of the path: the truth, a
/// reference that states its errors, or the innovations.
TuningScore score_to_tune_by(const Itinerary& itinerary, const Arguments& arguments) {
  const auto by = arguments.text("by");
  const ReferencePath* const reference = reference_to_tune_by(itinerary);
  if (!by) {
    if (itinerary.has_truth) return TuningScore::truth;
    const bool has_errors = reference != nullptr && !reference->covariance.empty();
    return has_errors ? TuningScore::reference : TuningScore::innovations;
  }
  if (*by != "reference" && *by != "innovations") {
    throw StudyError(
        "--by {}: no such score (a recorded drive has two): give reference or innovations", *by);
  }
  if (itinerary.has_truth) {
    throw StudyError(
        "--by {}: this study is simulated (its true poses are known, and score best): leave --by "
        "out",
        *by);
  }
  if (*by == "innovations") return TuningScore::innovations;
  if (reference != nullptr) return TuningScore::reference;
  throw StudyError(
      "--by reference: the drive has no reference: add reference.csv, or leave --by out");
}

/// Takes what the output says of the reference of a recorded drive.
void take_reference(const Itinerary& itinerary, TuningResult& result) {
  const ReferencePath* const reference = reference_to_tune_by(itinerary);
  if (result.score == TuningScore::truth || reference == nullptr) return;
  result.reference = reference->name;
  result.reference_has_errors = !reference->covariance.empty();
}

/// Runs the confirming study, stores it in `file` and returns its analysis.
StudyAnalysis analysis_of(const StudyPlan& plan, const fs::path& file, const Arguments& arguments) {
  RunOptions options;
  options.output = file;
  options.parallel = parallel_of(arguments);
  options.force = arguments.has("force");
  options.quiet = true;
  options.provenance = provenance_of("tune", arguments);
  const RunOutcome outcome = run_study(plan, options);
  if (outcome.stopped != StopReason::complete) throw RunError("tune: interrupted: call it again");
  return analyze(ResultFile(file), kUsualLevel, options.parallel);
}

/// The options that give the cell the noise that was found.
std::string options_text(const TunedNoise& noise, const CellSpec& tuned) {
  std::string text;
  for (const Parameter& option : mismatch_options()) {
    const TunedFactor& factor = option.key == "motion_noise" ? noise.motion : noise.sensor;
    if (factor.is_free()) text += " " + option.key + "=" + to_text(mismatch_of(tuned, option.key));
  }
  return text;
}

void print_findings(const TuningResult& result, const TuningConfirmation& confirmation,
                    const CellSpec& tuned) {
  const std::size_t width = output_width();
  const auto print = [&](const std::string& text) { std::cout << wrapped(text, width, 2); };
  for (const std::string& warning : tuning_warnings(result)) print(warning);
  print(tuning_sentence(result, confirmation));
  print("Write" + options_text(result.noise, tuned) + " into its cell.");
  std::cout << '\n';
  print_table(std::cout, tuning_table(result), width);
  print(tuning_table_note());
  std::cout << '\n';
  for (const std::string& note : tuning_notes(result, confirmation)) print(note);
  std::cout << '\n';
  print(landscape_note());
  print_table(std::cout, landscape_table(result.grid), width);
}

void write_folder(const TuningResult& result, const fs::path& folder) {
  make_directory(folder);
  write_csv(landscape_frame(result.grid), folder / "landscape.csv");
  if (!result.noise.motion.is_free()) return;  // no axis to draw over
  const Figure figure = landscape_figure(result);
  const Figure* const figures[] = {&figure};
  draw(figures, folder);
}

}  // namespace

int tune_command(const Arguments& arguments) {
  refuse_result(arguments.operands().front());
  const Study study = study_of(arguments);
  const CellSpec& cell = cell_to_tune(study, arguments);
  const std::uint64_t seed = seed_to_confirm(study, arguments);
  const auto folder = arguments.text("output");
  if (folder && !arguments.has("force"))
    refuse_existing(*folder, {kConfirmationFile, "landscape.csv", "figures", "data"});
  const Parallel parallel = parallel_of(arguments);
  const StudyPlan given = make_plan(study);
  const TuningScore score = score_to_tune_by(given.drives->itinerary_of(0), arguments);
  TuningResult result = find_noise(study, cell, score, parallel);
  const Study confirming = confirming_study(study, cell, result.noise, seed);
  const StudyPlan plan = make_plan(confirming);
  const PassingFolder passing;
  take_reference(given.drives->itinerary_of(0), result);
  if (score == TuningScore::innovations) {
    print_findings(result, confirm_by_innovations(confirming, plan, parallel),
                   confirming.cells.back());
  } else if (score == TuningScore::reference) {
    print_findings(result, confirm_by_reference(confirming, plan, parallel),
                   confirming.cells.back());
  } else {
    if (folder) make_directory(*folder);
    TuningConfirmation confirmation = confirm_on_runs(confirming, plan, parallel);
    const StudyAnalysis analysis = analysis_of(
        plan, (folder ? fs::path(*folder) : passing.path()) / kConfirmationFile, arguments);
    confirmation.answer = analysis.cells.back().verdict.answer;
    confirmation.is_slight = analysis.cells.back().verdict.is_slight();
    confirmation.verdict = in_words(analysis.cells.back().verdict);
    print_findings(result, confirmation, confirming.cells.back());
    std::cout << '\n';
    print_summary(std::cout, analysis, output_width());
  }
  if (folder) write_folder(result, *folder);
  return kDone;
}

}  // namespace montecarta::experiments
