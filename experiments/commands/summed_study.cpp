// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/summed_study.hpp"

#include "analysis/study/stored_sums.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/check_file.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/commands/stored_result.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <map>
#include <memory>
#include <string_view>

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
  return folder / formatted("{}_{}.h5", kind, first_run);
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

/// Runs one group that is not finished.
RunOutcome make_group(const StudyPlan& group, const fs::path& folder, const RunOptions& options,
                      std::optional<double> time_left) {
  const fs::path sums = file_in(folder, "group", group.first_run);
  RunOptions of_group = options;
  of_group.output = file_in(folder, "rows", group.first_run);
  of_group.force = false;
  of_group.resume = !options.attempt;
  of_group.progress = ProgressStyle::none;
  if (time_left) of_group.time_budget = std::max(*time_left, kShortestSitting);
  const RunOutcome outcome = run_study(group, of_group);
  if (outcome.counts.missing > 0) return outcome;
  write_group(sums, of_group.output, sums_to_store(ResultFile(of_group.output), options.parallel));
  fs::remove(of_group.output);
  return outcome;
}

/// Number of times that an attempt begins a group again because another one removed its files.
constexpr int kMostRetries = 3;

/// Runs one group, unless it is finished. Where another attempt finished the rows and removed those
/// of this one, this one takes over the rows that are there, or the finished group.
RunOutcome run_group(const StudyPlan& group, const fs::path& folder, const RunOptions& options,
                     std::optional<double> time_left) {
  const fs::path sums = file_in(folder, "group", group.first_run);
  for (int retries = 0;; ++retries) {
    if (is_finished(sums, group, options.provenance)) return {};
    try {
      return make_group(group, folder, options, time_left);
    } catch (const std::runtime_error&) {
      const bool has_rows = is_there(file_in(folder, "rows", group.first_run));
      const bool was_overtaken = has_rows || is_finished(sums, group, options.provenance);
      if (!options.attempt || !was_overtaken || retries == kMostRetries) throw;
    }
  }
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

/// Returns whether a file in the folder has that name because it holds runs or sums.
bool is_stored_work(const std::string& name) {
  return name.starts_with("group_") || name.starts_with("rows_");
}

/// Removes the runs and groups in the folder, and leaves other files.
void remove_groups(const fs::path& folder) {
  std::error_code ignored;  // another attempt may be removing the same
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_stored_work(name)) fs::remove(entry.path());
  }
}

/// Removes the finished work, and the folder if nothing else is in it.
void remove_work(const fs::path& folder) {
  remove_groups(folder);
  fs::remove(replaces_in(folder));
  fs::remove(lock_in(folder));
  std::error_code not_empty;
  fs::remove(folder, not_empty);
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

/// Begins or continues the work in the folder, which only one process may do at a time, or several
/// attempts. Returns its lock, which attempts do not hold, or nullopt if the result is complete
/// already.
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
  if (!options.attempt) lock.lock();
  if (options.force) {
    remove_groups(folder);
    PosixFile(replaces_in(folder), PosixFile::Mode::create);
  }
  return lock;
}

}  // namespace

fs::path groups_of(fs::path output) { return output += ".groups"; }

void remove_empty_work(const fs::path& output) {
  const fs::path folder = groups_of(output);
  std::error_code ignored;  // nothing here may take the place of the error that is under way
  for (fs::directory_iterator entry(folder, ignored), end; entry != end; entry.increment(ignored)) {
    if (is_stored_work(entry->path().filename().string())) return;
  }
  for (const fs::path& path : {replaces_in(folder), lock_in(folder), folder})
    fs::remove(path, ignored);
}

std::vector<fs::path> begun_files(const fs::path& output) {
  const fs::path folder = groups_of(output);
  std::error_code ignored;
  std::map<std::pair<std::uint64_t, std::string>, fs::path> found;
  if (is_there(output) || !fs::is_directory(folder, ignored)) return {};
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t begin = is_stored_work(name) ? name.find('_') + 1 : name.size();
    std::uint64_t run = 0;
    const auto [end, error] = std::from_chars(name.data() + begin, name.data() + name.size(), run);
    const std::string_view ending(end);
    if (error == std::errc() && (ending == ".h5" || ending == ".h5.part"))
      found.emplace(std::pair(run, name), entry.path());
  }
  std::vector<fs::path> files;
  for (const auto& [key, path] : found) files.push_back(path);
  return files;
}

namespace {

/// Makes the result of its groups. An attempt writes a file of its own, as other attempts may do.
void join_groups(const StudyPlan& plan, const RunOptions& options,
                 const std::vector<fs::path>& groups) {
  const bool replaces = is_there(replaces_in(groups_of(options.output)));
  if (!options.attempt || replaces) {
    merge_groups(options.output, groups, plan.first_run, plan.last_run,
                 replaces ? Existing::replace : Existing::refuse);
    return;
  }
  const fs::path own = name_of_attempt(options.output);
  merge_groups(own, groups, plan.first_run, plan.last_run, Existing::refuse);
  PosixFile file(own, PosixFile::Mode::write);
  complete_attempt(file, options.output);
}

/// Runs all groups and makes the result of them.
RunOutcome run_groups(const StudyPlan& plan, const RunOptions& options, const fs::path& folder) {
  const Stopwatch stopwatch;
  RunOutcome outcome;
  std::vector<fs::path> groups;
  for (std::uint64_t run = plan.first_run; run < plan.last_run; run += kRunsOfAGroup) {
    const StudyPlan group = group_of(plan, run);
    std::optional<double> left = options.time_budget;
    if (left) *left -= stopwatch.seconds();
    const RunOutcome part = run_group(group, folder, options, left);
    outcome.signal = part.signal;
    outcome.stopped = group.last_run < plan.last_run && part.stopped == StopReason::complete
                          ? part.signal
                          : part.stopped;
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
  join_groups(plan, options, groups);
  remove_work(folder);
  outcome.counts = counts_in(options.output);
  return outcome;
}

/// The outcome of a study that is complete already.
RunOutcome finished_outcome(const RunOptions& options) {
  RunOutcome outcome;
  outcome.counts = counts_in(options.output);
  return outcome;
}

RunOutcome run_or_continue(const StudyPlan& plan, const RunOptions& options,
                           const fs::path& folder) {
  const std::optional<PosixFile> lock = open_work(folder, plan, options);
  if (!lock) return finished_outcome(options);
  try {
    return run_groups(plan, options, folder);
  } catch (...) {
    if (!options.attempt) remove_empty_work(options.output);
    throw;
  }
}

}  // namespace

RunOutcome run_summed_study(const StudyPlan& plan, const RunOptions& options) {
  const fs::path folder = groups_of(options.output);
  try {
    return run_or_continue(plan, options, folder);
  } catch (const std::runtime_error&) {
    if (!options.attempt || !is_there(options.output)) throw;
  }
  require_result_of(plan, options);  // another attempt finished it, and removed the groups
  remove_work(folder);
  return finished_outcome(options);
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
