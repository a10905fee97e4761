// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/summed_study.hpp"

#include "analysis/study/stored_sums.hpp"
#include "engine/errors.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/read_description.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/commands/stored_result.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr double kShortestSitting = 0.001;  // [s] shortest time budget

/// The plan of one group of a study.
StudyPlan group_of(const StudyPlan& plan, std::uint64_t first_run) {
  StudyPlan group = plan;
  group.first_run = first_run;
  group.last_run = std::min(first_run + kRunsOfAGroup, plan.last_run);
  return group;
}

fs::path file_in(const fs::path& folder, const char* kind, std::uint64_t first_run) {
  return folder / (std::string(kind) + "_" + std::to_string(first_run) + ".h5");
}

/// The description of a finished group. Throws StudyError if a byte of it is damaged.
ResultDescription description_of_group(const fs::path& path) {
  const ResultFile file(path);
  for (const StoredCell& cell : file.cells()) {
    if (file.has_sums()) file.sum_groups(cell);  // throws if the file lacks its seal
    for (std::size_t i = 0; i < file.runs().size(); ++i) file.expect_whole(cell, i);
  }
  return file.description();
}

bool is_of_runs(const ResultDescription& stored, const StudyPlan& plan) {
  return stored.sums && stored.sums->first_run == plan.first_run &&
         stored.sums->last_run == plan.last_run;
}

/// Returns whether the file is the finished group of this plan; a damaged one is computed again.
/// Throws StudyError if it is of another study.
bool is_finished(const fs::path& path, const StudyPlan& group, const TextPairs& provenance) {
  if (!is_there(path)) return false;
  ResultDescription stored;
  try {
    stored = description_of_group(path);
  } catch (const std::runtime_error&) {
    return false;
  }
  if (const auto differs = difference(describe(group, provenance), stored, path))
    throw StudyError(*differs + ", or begin anew with --force");
  return is_of_runs(stored, group);
}

RunCounts counts_in(const fs::path& path) {
  const ResultFile file(path);
  RunCounts counts;
  for (const StoredCell& cell : file.cells()) counts += count_status(file, cell);
  return counts;
}

/// Runs one group, unless it is finished.
RunOutcome run_group(const StudyPlan& group, const fs::path& folder, const RunOptions& options,
                     std::optional<double> time_left) {
  const fs::path sums = file_in(folder, "group", group.first_run);
  if (is_finished(sums, group, options.provenance)) return {};
  RunOptions of_group = options;
  of_group.output = file_in(folder, "rows", group.first_run);
  of_group.force = false;
  of_group.attempt = false;
  of_group.resume = true;
  of_group.progress = ProgressStyle::none;
  if (time_left) of_group.time_budget = std::max(*time_left, kShortestSitting);
  const RunOutcome outcome = run_study(group, of_group);
  if (outcome.counts.missing > 0) return outcome;
  write_group(sums, of_group.output, sums_to_store(ResultFile(of_group.output), options.parallel));
  fs::remove(of_group.output);
  return outcome;
}

void show_progress(const StudyPlan& plan, std::uint64_t done, double seconds,
                   const RunOptions& options) {
  if (options.quiet || options.progress == ProgressStyle::none) return;
  std::fprintf(stderr, "montecarta: %llu of %llu runs after %.0f s\n",
               static_cast<unsigned long long>(done),
               static_cast<unsigned long long>(plan.runs_here()), seconds);
}

/// The file whose existence says that the work replaces a result, which a later session must know.
fs::path replaces_in(const fs::path& folder) { return folder / "replaces"; }
fs::path lock_in(const fs::path& folder) { return folder / "lock"; }

/// Removes the runs and groups in the folder, and leaves other files.
void remove_groups(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("group_") || name.starts_with("rows_")) fs::remove(entry.path());
  }
}

/// Removes the finished work, and the folder if nothing else is in it.
void remove_work(const fs::path& folder) {
  remove_groups(folder);
  fs::remove(replaces_in(folder));
  fs::remove(lock_in(folder));
  if (fs::is_empty(folder)) fs::remove(folder);
}

/// Throws StudyError if a finished result is not that of this plan.
void require_result_of(const StudyPlan& plan, const RunOptions& options) {
  const ResultDescription stored = read_description(options.output);
  const auto differs = difference(describe(plan, options.provenance), stored, options.output);
  if (differs) throw StudyError(*differs);
  if (is_of_runs(stored, plan)) return;
  throw StudyError(options.output.string() +
                   ": holds other runs than those to be computed: choose another output");
}

/// Begins or continues the work in the folder, which only one process may do at a time. Returns its
/// lock, or nullopt if the result is complete already.
std::optional<PosixFile> open_work(const fs::path& folder, const StudyPlan& plan,
                                   const RunOptions& options) {
  const bool goes_on = options.resume || options.attempt, has_work = is_there(folder);
  if (!has_work && goes_on && is_there(options.output)) {
    require_result_of(plan, options);
    return std::nullopt;
  }
  if (has_work && !goes_on && !options.force) {
    throw StudyError(folder.string() +
                     ": holds unfinished work: continue it with --resume, or start afresh with "
                     "--force");
  }
  if (!options.force && !is_there(replaces_in(folder))) require_free(options.output);
  fs::create_directory(folder);
  PosixFile lock(lock_in(folder), PosixFile::Mode::create);
  lock.lock();
  if (options.force) {
    remove_groups(folder);
    PosixFile(replaces_in(folder), PosixFile::Mode::create);
  }
  return lock;
}

}  // namespace

fs::path groups_of(fs::path output) { return output += ".groups"; }

RunOutcome run_summed_study(const StudyPlan& plan, const RunOptions& options) {
  const Stopwatch stopwatch;
  const fs::path folder = groups_of(options.output);
  RunOutcome outcome;
  const std::optional<PosixFile> lock = open_work(folder, plan, options);
  if (!lock) {
    outcome.counts = counts_in(options.output);
    return outcome;
  }
  std::vector<fs::path> groups;
  for (std::uint64_t run = plan.first_run; run < plan.last_run; run += kRunsOfAGroup) {
    const StudyPlan group = group_of(plan, run);
    std::optional<double> left = options.time_budget;
    if (left) *left -= stopwatch.seconds();
    const RunOutcome part = run_group(group, folder, options, left);
    outcome.stopped = part.stopped;
    outcome.runs_here += part.runs_here;
    if (outcome.stopped != StopReason::complete) {
      outcome.counts.missing =
          part.counts.missing + (plan.last_run - group.last_run) * plan.cells.size();
      break;
    }
    groups.push_back(file_in(folder, "group", run));
    show_progress(plan, group.last_run - plan.first_run, stopwatch.seconds(), options);
  }
  outcome.seconds = stopwatch.seconds();
  if (outcome.stopped != StopReason::complete) return outcome;
  merge_groups(options.output, groups, plan.first_run, plan.last_run,
               is_there(replaces_in(folder)) ? Existing::replace : Existing::refuse);
  remove_work(folder);
  outcome.counts = counts_in(options.output);
  return outcome;
}

std::vector<NewGroup> computed_group(const StudyPlan& plan, std::uint64_t first_run,
                                     const fs::path& folder, const Parallel& parallel) {
  RunOptions options;
  options.output = file_in(folder, "rows", first_run);
  options.parallel = parallel;
  options.quiet = true;
  fs::create_directory(folder);
  const std::unique_ptr<const fs::path, void (*)(const fs::path*)> removed(
      &folder, [](const fs::path* made) { fs::remove_all(*made); });
  const RunOutcome outcome = run_study(group_of(plan, first_run), options);
  std::vector<NewGroup> sums;
  if (outcome.counts.missing == 0) sums = sums_to_store(ResultFile(options.output), parallel);
  if (sums.empty()) throw RunError(folder.string() + ": interrupted: call it again");
  return sums;
}

}  // namespace montecarta::experiments
