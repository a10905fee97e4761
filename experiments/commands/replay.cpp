// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/runs/recompute.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/study/setting_table.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace montecarta::experiments {
namespace {

/// Returns the names of all columns that this study can record. Without identities there is no
/// ground truth for associations.
std::string all_columns(const Study& study) {
  std::vector<std::string> columns;
  for (const Setting& setting : study_settings()) {
    if (setting.section == "record" && setting.key == "columns") columns = setting.choices;
  }
  std::erase(columns, "sums");  // sums would replace the rows that are to be drawn
  if (identities_of(study) == 0) std::erase(columns, "association");
  if (!objection_to_joint(study).empty()) std::erase(columns, "joint");
  if (!objection_to_observability(study).empty()) std::erase(columns, "observability");
  if (!objection_to_evolution(study).empty()) std::erase(columns, "evolution");
  return joined(columns, ", ");
}

/// Returns the study reduced to one run of one cell, with everything recorded.
Study recording_everything(Study study, std::size_t cell, std::uint64_t run) {
  study.cells = {study.cells[cell]};
  study.until.reset();  // a single run never stops early
  study.settings.replace("study", "until", "");
  study.settings.replace("record", "columns", all_columns(study));
  study.settings.replace("record", "full_runs", "0");  // there is only one run
  study.settings.replace("record", "rate", "control");
  if (study.logs.size() < 2) return study;
  study.log_folders = {study.log_folders.at(run)};
  study.logs = {study.logs.at(run)};  // a single drive allows recording every step
  study.settings.replace("scenario", "data_sha256", fingerprint_of(*study.logs.front()));
  return study;
}

/// Describes the difference from the stored run in a sentence; nullopt if there is none or the run
/// is not stored.
std::optional<std::string> departure(const ResultFile& file, const Study& study, std::size_t cell,
                                     std::uint64_t run, ExternalPrograms programs) {
  if (cell >= file.cells().size() || file.cells()[cell].label != study.cells[cell].label) {
    throw StudyError(file.path().string() +
                     ": damaged (its cells are not those of the study in it): take a copy that is "
                     "whole, or run the study again");
  }
  const auto held = std::ranges::find(file.runs(), run);
  const auto index = static_cast<std::size_t>(held - file.runs().begin());
  if (held == file.runs().end() || !is_stored(file.status(file.cells()[cell])[index])) {
    std::cerr << "montecarta: " << file.path().string() << " does not hold this run yet\n";
    return std::nullopt;
  }
  const StudyPlan plan = make_plan(study, std::nullopt, programs);
  return Recomputation(file.path(), file.description(), plan).difference({cell, index});
}

RunOptions options_of(const Arguments& arguments, const std::string& output) {
  RunOptions options;
  options.output = output;
  options.parallel = parallel_of(arguments);
  options.force = arguments.has("force");
  options.quiet = true;
  options.provenance = provenance_of("replay", arguments);
  return options;
}

}  // namespace

int replay_command(const Arguments& arguments) {
  const std::string output = arguments.text("output").value();
  const std::string label = arguments.text("cell").value();
  const ResultFile file = open_stored(arguments.operands().front());
  const std::uint64_t run = arguments.count("run", 0, file.study_runs() - 1).value();
  refuse_input_as_output(output, arguments.operands());
  require_place_for_result(output);
  const Study study = study_in(file, arguments);
  const CellSpec& chosen = item_called(label, study.cells, &CellSpec::label,
                                       formatted("--cell {}: no cell of this study", label));
  const auto cell = static_cast<std::size_t>(&chosen - study.cells.data());
  const Study whole = recording_everything(study, cell, run);
  const ExternalPrograms programs = programs_of(whole, arguments);
  const auto departs = departure(file, study, cell, run, programs);
  const StudyPlan plan = make_plan(whole, RunRange{run, run + 1}, programs);
  const RunOutcome outcome = run_study(plan, options_of(arguments, output));
  if (outcome.counts.missing > 0) return exit_code(outcome, runs_under_scheduler());
  std::cerr << "montecarta: run " << run << " of " << label << " with everything recorded, "
            << bytes_text(static_cast<double>(std::filesystem::file_size(output))) << ", stored in "
            << output << "\n";
  if (!departs) return exit_code(outcome, runs_under_scheduler());
  std::cout << wrapped(*departs, output_width(), 2);
  return kDifferent;
}

}  // namespace montecarta::experiments
