// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/text/number_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/benchmark/archive_entry.hpp"
#include "experiments/benchmark/benchmark_study.hpp"
#include "experiments/benchmark/matrix.hpp"
#include "experiments/benchmark/matrix_figure.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_work.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// One filter in one world, with the file that says that it is done.
struct BenchmarkTask {
  BenchmarkFilter filter;
  std::string world;
  fs::path entry;

  fs::path result() const { return fs::path(entry).replace_extension(".h5"); }
  std::string name() const { return formatted("{} in {}", filter.label, world); }
};

/// What one process does in a folder, perhaps beside others.
struct BenchmarkWorker {
  SharedWork work;
  fs::path folder;

  const Arguments& arguments() const { return work.arguments(); }
  std::optional<std::uint64_t> runs() const { return arguments().count("runs", 3, 1'000'000); }
  Study study(const BenchmarkTask& task) const {
    return benchmark_study(task.world, task.filter.cell, runs());
  }
};

std::vector<std::string> worlds_of(const Arguments& arguments) {
  std::vector<std::string> all = benchmark_worlds();
  const auto names = arguments.text("world");
  if (!names) return all;
  std::vector<std::string> chosen = split(*names, ',');
  for (const std::string& name : chosen) {
    item_called(name, all, std::identity(),
                formatted("--world {}: no world of the benchmark", name));
  }
  return chosen;
}

std::vector<BenchmarkFilter> filters_to_run(const Arguments& arguments) {
  const std::vector<std::string> cells = arguments.texts("cell");
  if (cells.empty()) return benchmark_filters();
  std::vector<BenchmarkFilter> filters;
  for (const std::string& cell : cells) {
    filters.push_back(filter_of_cell(cell));
    if (std::ranges::count(filters, filters.back().label, &BenchmarkFilter::label) > 1) {
      throw StudyError(
          "--cell {}: a second filter with the label {} (its results would have the same name): "
          "add label=NAME",
          cell, filters.back().label);
    }
  }
  return filters;
}

/// The tasks of all filters in the worlds that suit them. Throws StudyError if no world suits a
/// filter.
std::vector<BenchmarkTask> tasks_of(const BenchmarkWorker& worker) {
  std::vector<BenchmarkTask> tasks;
  for (const BenchmarkFilter& filter : filters_to_run(worker.arguments())) {
    const std::size_t before = tasks.size();
    const std::vector<std::string> worlds = worlds_of(worker.arguments());
    for (const std::string& world : worlds) {
      if (suits(world, filter.cell))
        tasks.push_back({filter, world, path_of_entry(worker.folder, world, filter.label)});
    }
    if (tasks.size() == before) benchmark_study(worlds.front(), filter.cell);  // throws the reason
  }
  return tasks;
}

/// Throws StudyError if an entry is there that is not of this study.
void require_same_study(const BenchmarkWorker& worker, const BenchmarkTask& task) {
  const ArchiveEntry entry = read_entry(task.entry);
  if (entry.study_sha256 == sha256(resolved_text(worker.study(task)))) return;
  throw StudyError(
      "{}: holds the result of another study (of other runs, or of another filter with this "
      "label): choose another folder, or another label",
      task.entry);
}

/// Runs a study, or continues it. The error of work that another study began names it as well.
RunOutcome run_or_continue(const BenchmarkTask& task, const StudyPlan& plan,
                           const RunOptions& options) {
  const bool is_begun = is_there(groups_of(options.output));
  try {
    return run_summed_study(plan, options);
  } catch (const StudyError& error) {
    if (!is_begun) throw;
    throw StudyError("{}; or give the filter another label, or remove {}", error.what(),
                     groups_of(task.result()));
  }
}

/// Computes a result and writes its entry. Returns 0, or the exit code of a process that was
/// stopped.
int compute(const BenchmarkWorker& worker, const BenchmarkTask& task, WorkClaim& claim) {
  const SharedWork& work = worker.work;
  const Study study = worker.study(task);
  const StudyPlan plan = make_plan(study, std::nullopt, programs_of(study, work.arguments()));
  RunOptions options = work.options_to(task.result());
  options.quiet = true;
  const RunOutcome outcome = run_or_continue(task, plan, options);
  if (outcome.counts.missing > 0) return work.leave(outcome, task.name(), claim);
  write_entry(entry_of(ResultFile(task.result()), task.world, task.filter.cell,
                       parallel_of(work.arguments())),
              worker.folder);
  work.say(formatted("{}: {} runs in {}", task.name(), outcome.counts.ended(),
                     duration_text(outcome.seconds)));
  return work.finish(outcome);
}

/// Makes a result that is claimed, and removes the claims on it. Returns as compute() does.
int make_claimed(const BenchmarkWorker& worker, const BenchmarkTask& task,
                 std::unique_ptr<WorkClaim> claim) {
  return SharedWork::make_claimed(std::move(claim),
                                  [&](WorkClaim& own) { return compute(worker, task, own); });
}

/// The tasks without an entry, by the path of the entry.
std::map<fs::path, const BenchmarkTask*> missing_of(std::span<const BenchmarkTask> tasks) {
  std::map<fs::path, const BenchmarkTask*> missing;
  for (const BenchmarkTask& task : tasks) {
    if (!is_there(task.entry)) missing.emplace(task.entry, &task);
  }
  return missing;
}

std::vector<fs::path> paths_in(const std::map<fs::path, const BenchmarkTask*>& tasks) {
  std::vector<fs::path> paths;
  for (const auto& [path, task] : tasks) paths.push_back(path);
  return paths;
}

/// Works until no task is left that no other process is at. Filters are run in their order.
int run_tasks(const BenchmarkWorker& worker, std::span<const BenchmarkTask> tasks) {
  for (const BenchmarkTask& task : tasks) {
    fs::create_directories(task.entry.parent_path());
    if (is_there(task.entry)) require_same_study(worker, task);
    programs_of(worker.study(task), worker.arguments());
  }
  for (const BenchmarkTask& task : tasks) {
    if (is_there(task.entry)) continue;
    auto claim = claim_free({task.entry}, worker.work.patience());
    if (!claim) continue;
    const int code = make_claimed(worker, task, std::move(claim));
    if (code != kDone) return code;
  }
  for (auto missing = missing_of(tasks); !missing.empty(); missing = missing_of(tasks)) {
    ClaimSearch found = watch_others(paths_in(missing), worker.work.patience());
    if (!found.claim) {
      if (!found.given_up.empty()) refuse_to_begin(found.given_up, "benchmark");
      worker.work.say(formatted(
          "other processes are at {} results; the same command continues if they are ended",
          missing.size()));
      return kDone;
    }
    const BenchmarkTask& task = *missing.at(found.claim->file());
    const int code = make_claimed(worker, task, std::move(found.claim));
    if (code != kDone) return code;
  }
  return kDone;
}

/// The entries of the folder and, if asked for, those of the archive that the folder has not.
std::vector<ArchiveEntry> entries_to_draw(const BenchmarkWorker& worker) {
  std::vector<ArchiveEntry> entries = read_entries(worker.folder);
  if (!worker.arguments().has("archive")) return entries;
  for (ArchiveEntry& archived : read_entries(shipped_archive())) {
    const bool is_mine = std::ranges::any_of(entries, [&](const ArchiveEntry& mine) {
      return mine.world == archived.world && mine.label == archived.label;
    });
    if (!is_mine) entries.push_back(std::move(archived));
  }
  return entries;
}

void draw(const BenchmarkWorker& worker) {
  const std::vector<ArchiveEntry> entries = entries_to_draw(worker);
  if (entries.empty()) {
    throw StudyError(
        "{}: holds no result of the benchmark (WORLD/LABEL.json): run it without --draw, or choose "
        "another folder",
        worker.folder);
  }
  const Matrix matrix = matrix_of(entries);
  const std::size_t width = output_width();
  print_table(std::cout, ratio_table(matrix), width);
  std::cout << "\n" << wrapped(legend_text(matrix), width);
  const fs::path folder = worker.arguments().text("output").value_or(worker.folder.string());
  make_directory(folder);
  write_text(folder / "matrix.svg", matrix_figure(matrix));
  write_text(folder / "index.html", matrix_page(matrix));
  write_csv(matrix_frame(matrix), folder / "matrix.csv");
  std::cout << wrapped("Page: " + (folder / "index.html").string(), width);
}

}  // namespace

int benchmark_command(const Arguments& arguments) {
  const BenchmarkWorker worker{SharedWork(arguments, "benchmark"), arguments.operands().front()};
  if (!arguments.has("draw")) {
    const int code = run_tasks(worker, tasks_of(worker));
    if (code != kDone) return code;
  }
  draw(worker);
  return kDone;
}

}  // namespace montecarta::experiments
