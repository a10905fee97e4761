// SPDX-License-Identifier: BSD-3-Clause
#include "engine/core/unusable_filter.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/benchmark/archive_entry.hpp"
#include "experiments/benchmark/benchmark_study.hpp"
#include "experiments/benchmark/matrix.hpp"
#include "experiments/benchmark/matrix_figure.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/benchmark_task.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_work.hpp"
#include "experiments/commands/stale_results.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <iostream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <span>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

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

/// Runs a study, or continues it.
RunOutcome run_or_continue(const BenchmarkTask& task, const StudyPlan& plan,
                           const RunOptions& options) {
  try {
    return run_summed_study(plan, options);
  } catch (const UnusableFilter& error) {
    throw UnusableFilter("{}: {}; --world NAME,... leaves out worlds that it does not model",
                         task.name(), error.what());
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
  std::ranges::copy(provenance_of_files(program_files_of(study)),
                    std::back_inserter(options.provenance));
  remove_stale_work(worker, task);
  const RunOutcome outcome = run_or_continue(task, plan, options);
  if (outcome.counts.missing > 0) return work.leave(outcome, task.name(), claim);
  const ArchiveEntry entry = entry_of(ResultFile(task.result()), task.world, task.filter.cell,
                                      parallel_of(work.arguments()));
  write_entry(entry, worker.folder);
  const std::string failures =
      entry.failed == 0 ? ""
                        : formatted(", {} FAILED (first: {})", entry.failed, entry.first_failure);
  work.say(formatted("{}: {} runs in {}{}", task.name(), entry.runs, duration_text(outcome.seconds),
                     failures));
  return work.finish(outcome);
}

/// Whether an error remains until the user mends its cause.
bool is_for_user(const std::exception& error) {
  return dynamic_cast<const StudyError*>(&error) != nullptr ||
         dynamic_cast<const UnusableFilter*>(&error) != nullptr;
}

/// Computes a result as compute() does. After an error that the user must mend, removes the folder
/// of work that has stored nothing, and withdraws the claim, so that no number of attempts stands
/// in the way of the mended filter.
int compute_or_withdraw(const BenchmarkWorker& worker, const BenchmarkTask& task,
                        WorkClaim& claim) {
  try {
    return compute(worker, task, claim);
  } catch (const std::exception& error) {
    if (is_for_user(error)) {
      remove_empty_work(task.result());
      claim.withdraw();
    }
    throw;
  }
}

/// Makes a result that is claimed, unless another worker has made it meanwhile, and removes the
/// claims on it. Returns as compute() does.
int make_claimed(const BenchmarkWorker& worker, const BenchmarkTask& task,
                 std::unique_ptr<WorkClaim> claim) {
  try {
    remove_stale_result(worker, task);
  } catch (...) {
    claim->withdraw();
    throw;
  }
  return SharedWork::make_claimed(
      std::move(claim), [&](WorkClaim& own) { return compute_or_withdraw(worker, task, own); });
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

/// Date and time of the last change of a file, in UTC.
std::string date_of(const fs::path& path) {
  const auto changed = std::chrono::file_clock::to_sys(fs::last_write_time(path));
  const std::time_t time = std::chrono::system_clock::to_time_t(
      std::chrono::time_point_cast<std::chrono::system_clock::duration>(changed));
  std::tm utc{};
  gmtime_r(&time, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", &utc);
  return text.data();
}

/// Says which results are kept, in a line for each filter.
void say_kept(const BenchmarkWorker& worker, std::span<const BenchmarkTask> kept) {
  constexpr std::size_t kMostNamed = 3;
  while (!kept.empty()) {
    const std::string& label = kept.front().filter.label;
    std::vector<std::string> worlds, dates;
    for (const BenchmarkTask& task : kept) {
      if (task.filter.label != label) break;
      worlds.push_back(task.world);
      dates.push_back(date_of(task.entry));
    }
    const auto [first, last] = std::ranges::minmax(dates);
    const bool is_unknown = std::ranges::any_of(kept.first(worlds.size()), is_of_unknown_files);
    worker.work.say(formatted(
        "{} in {}: result of {} kept, not computed again{}", label,
        worlds.size() > kMostNamed ? formatted("{} worlds", worlds.size()) : joined(worlds),
        first == last ? first : first + " to " + last,
        is_unknown ? " (no file of its program is stored, so a change of it is not noticed)" : ""));
    kept = kept.subspan(worlds.size());
  }
}

/// Claims the tasks one by one, in the order of filters, and makes those that no other process is
/// at.
int make_free_tasks(const BenchmarkWorker& worker, std::span<const BenchmarkTask> tasks) {
  for (const BenchmarkTask& task : tasks) {
    if (has_result(worker, task)) continue;
    auto claim = claim_free({task.entry}, worker.work.patience());
    if (!claim) {
      if (is_there(task.entry))
        worker.work.say(task.name() + ": another process has claimed it; the old result remains");
      continue;
    }
    const int code = make_claimed(worker, task, std::move(claim));
    if (code != kDone) return code;
  }
  return kDone;
}

/// Works until no task is left that no other process is at.
int run_tasks(const BenchmarkWorker& worker, std::span<const BenchmarkTask> tasks) {
  std::vector<BenchmarkTask> kept;
  for (const BenchmarkTask& task : tasks) {
    programs_of(worker.study(task), worker.arguments());
    fs::create_directories(task.entry.parent_path());
    if (has_result(worker, task)) kept.push_back(task);
  }
  say_kept(worker, kept);
  const int code_of_free = make_free_tasks(worker, tasks);
  if (code_of_free != kDone) return code_of_free;
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

/// Prints the ratios of the worlds that were asked for.
void print_ratios(const BenchmarkWorker& worker, std::vector<ArchiveEntry> entries) {
  const std::vector<std::string> worlds = worlds_of(worker.arguments());
  std::erase_if(entries, [&](const ArchiveEntry& entry) {
    return std::ranges::count(worlds, entry.world) == 0;
  });
  const Matrix matrix = matrix_of(entries);
  print_table(std::cout, ratio_table(matrix), output_width());
  std::cout << "\n" << wrapped(legend_text(matrix), output_width());
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
  print_ratios(worker, entries);
  const Matrix matrix = matrix_of(entries);
  const fs::path folder = worker.arguments().text("output").value_or(worker.folder.string());
  make_directory(folder);
  write_text(folder / "matrix.svg", matrix_figure(matrix));
  write_text(folder / "index.html", matrix_page(matrix));
  write_csv(matrix_frame(matrix), folder / "matrix.csv");
  std::cout << wrapped("Page: " + (folder / "index.html").string(), output_width());
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
