// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/report.hpp"
#include "engine/errors.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/runs/progress.hpp"
#include "engine/text/number_text.hpp"
#include "engine/text/visible_text.hpp"
#include "engine/threads/thread_budget.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/array_index.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/files/files.hpp"

#include <filesystem>
#include <iostream>

namespace montecarta::experiments {
namespace {

ProgressStyle progress_of(const Arguments& arguments) {
  const auto style = arguments.text("progress");
  return style == "plain"  ? ProgressStyle::plain
         : style == "none" ? ProgressStyle::none
                           : ProgressStyle::automatic;
}

/// The command line that continues this run after an interruption.
std::string resuming_command(const Arguments& arguments) {
  std::string line = program_path().string() + " run";
  for (const std::string& word : arguments.words()) {
    if (word == "--force" || word == "--resume") continue;
    const std::size_t value = word.starts_with("--shard=") ? word.find('=') + 1 : 0;
    line += " " + shell_quoted(word.substr(0, value) + with_array_index(word.substr(value)));
  }
  return arguments.has("attempt") ? line : line + " --resume";
}

/// The file given by -o, or a file in the current folder that is named after the study.
std::filesystem::path output_of(const Study& study, const Arguments& arguments) {
  if (const auto output = arguments.text("output")) return *output;
  if (arguments.has("shard"))
    throw StudyError("run: -o OUT.h5 is missing (each shard needs a name): add e.g. -o shard0.h5");
  const std::string& name = study.settings.text("study", "name");
  if (name.find('/') != std::string::npos)
    throw StudyError(
        "run: -o OUT.h5 is missing (the study's name '{}' names no file here): add e.g. -o "
        "results.h5",
        name);
  return name + ".h5";
}

/// Folder of the report, which only a study without -o writes; nullopt if there is none.
std::optional<std::filesystem::path> report_folder(const RunOptions& options,
                                                   const Arguments& arguments) {
  if (arguments.has("output") || options.quiet) return std::nullopt;
  std::filesystem::path folder = options.output.stem() += "_report";
  if (!options.force) refuse_existing(folder, analysis::report_names());
  return folder;
}

RunOptions options_of(const Study& study, const Arguments& arguments) {
  if (arguments.has("force") && (arguments.has("resume") || arguments.has("attempt"))) {
    throw StudyError(
        "--force and {}: one contradicts the other (go on, or begin anew?): remove one of them",
        arguments.has("resume") ? "--resume" : "--attempt");
  }
  RunOptions options;
  options.output = output_of(study, arguments);
  require_place_for_result(options.output);
  options.parallel = parallel_of(arguments);
  options.resume = arguments.has("resume");
  options.force = arguments.has("force");
  options.attempt = arguments.has("attempt");
  options.time_budget = arguments.number("time-budget", kLeastBudget, 1e9);
  options.progress = progress_of(arguments);
  options.quiet = arguments.has("quiet");
  options.provenance = provenance_of("run", arguments);
  return options;
}

void print_how_to_resume(const RunOutcome& outcome, const std::filesystem::path& work,
                         const Arguments& arguments) {
  std::cerr << "montecarta: stopped; " << outcome.counts.missing
            << " runs are missing, the finished ones are in " << work.string()
            << ". Continue with:\n  " << resuming_command(arguments) << "\n";
}

/// Draws the report and returns the path of its page, or an empty text if it cannot be drawn, e.g.
/// without gnuplot. That is not an error of the study, because the results are stored by now.
std::string draw_report(const ResultFile& file, const std::filesystem::path& folder,
                        const RunOptions& options) {
  analysis::ReportOptions how;
  how.parallel = &options.parallel;
  try {
    analysis::write_report(file, folder, how);
    return (folder / "index.html").string();
  } catch (const std::exception& error) {
    std::cerr << "montecarta: no report: " << error.what() << "\n";
    return "";
  }
}

void print_results(const RunOptions& options, const std::optional<std::filesystem::path>& report) {
  const std::string name = options.output.string();
  if (print_verdict(options.output, options.parallel)) {
    print_where_to_look(name, report ? draw_report(ResultFile(name), *report, options) : "");
  } else if (report) {
    std::cout << "The report: montecarta report " << shell_quoted(name) << " -o "
              << shell_quoted(report->string()) << "\n";
  }
}

}  // namespace

int run_command(const Arguments& arguments) {
  const Study study = study_of(arguments);
  const RunOptions options = options_of(study, arguments);
  const auto report = report_folder(options, arguments);
  programs_of(study, arguments);
  const StudyPlan plan = plan_of(study, arguments);
  const RunOutcome outcome =
      plan.columns.sums ? run_summed_study(plan, options) : run_study(plan, options);
  if (outcome.counts.missing > 0) {
    print_how_to_resume(outcome,
                        plan.columns.sums ? groups_of(options.output) : part_of(options.output),
                        arguments);
    return exit_code(outcome, runs_under_scheduler());
  }
  if (!options.quiet) {
    print_results(options, report);
    std::cerr << "montecarta: " << outcome.runs_here << " runs in "
              << duration_text(outcome.seconds) << ", stored in " << options.output.string()
              << "\n";
  }
  return exit_code(outcome, runs_under_scheduler());
}

}  // namespace montecarta::experiments
