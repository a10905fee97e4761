// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/plan_arguments.hpp"

#include "engine/errors.hpp"
#include "engine/records/provenance.hpp"
#include "engine/threads/thread_budget.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/make_plan.hpp"

#include <filesystem>

namespace montecarta::experiments {
namespace {

std::optional<RunRange> range_of(const Arguments& arguments, std::uint64_t runs) {
  const auto range = arguments.text("runs");
  const auto shard = arguments.text("shard");
  if (range && shard) {
    throw StudyError("--runs and --shard: both choose runs (one is enough): remove one of them");
  }
  if (range) return parse_run_range(*range, runs);
  if (shard) return parse_shard(*shard, runs);
  return std::nullopt;
}

/// The file of a study that comes with the program, as `montecarta list studies` names them.
std::optional<std::filesystem::path> shipped_study(const std::string& name) {
  if (name.find('/') != std::string::npos) return std::nullopt;
  return shipped_file("studies", name + ".ini");
}

}  // namespace

std::vector<OptionSpec> plan_options() {
  return {{"set", "", {"SECTION.KEY=VALUE"}, "override a setting of the study; repeatable", true},
          {"runs", "", {"A:B"}, "only runs A to B-1"},
          {"shard", "", {"I/N"}, "only part I (from 0) of N"},
          external_option(),
          {"threads", "", {"N"}, "default: what this process may use"},
          {"backend", "", {"tbb|openmp|serial"}, "how runs are spread over threads; same results"}};
}

OptionSpec external_option() {
  return {kAllowExternal,
          "",
          {},
          "start the programs that cells of the study name: read them first, if it is not yours"};
}

ExternalPrograms programs_of(const Study& study, const Arguments& arguments) {
  if (arguments.has(kAllowExternal)) return ExternalPrograms::allowed;
  for (const CellSpec& cell : study.cells) {
    if (!starts_program(*cell.filter)) continue;
    throw StudyError(cell.place + ": cell " + cell.label +
                     " is a program, which runs with all that you may do: " + cell_line(cell) +
                     " (nothing is started unasked): if you trust it, add --" + kAllowExternal);
  }
  return ExternalPrograms::refused;
}

Study study_of(const Arguments& arguments) {
  const std::string& name = arguments.operands().front();
  const auto shipped = std::filesystem::exists(name) ? std::nullopt : shipped_study(name);
  return read_study(shipped.value_or(name), arguments.texts("set"));
}

StudyPlan plan_of(const Study& study, const Arguments& arguments) {
  return make_plan(
      study, range_of(arguments, study.settings.count("study", "runs")),
      arguments.has(kAllowExternal) ? ExternalPrograms::allowed : ExternalPrograms::refused);
}

Parallel parallel_of(const Arguments& arguments) {
  const std::string backend = arguments.choice("backend", {"tbb", "openmp", "serial"});
  const int threads = thread_budget(arguments.text("threads")).threads;
  if (backend == "serial") return Parallel::serial();
  return Parallel(backend == "openmp" ? Backend::openmp : Backend::tbb, threads);
}

TextPairs provenance_of(const std::string& command, const Arguments& arguments) {
  std::string line = "montecarta " + command;
  for (const std::string& word : arguments.words()) line += " " + shell_quoted(word);
  TextPairs provenance = collect_provenance();
  provenance.emplace_back("command_line", line);
  provenance.emplace_back("backend", arguments.choice("backend", {"tbb", "openmp", "serial"}));
  provenance.emplace_back("threads", std::to_string(parallel_of(arguments).threads()));
  return provenance;
}

}  // namespace montecarta::experiments
