// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/summed_study.hpp"

#include "analysis/metrics/stored_sums.hpp"
#include "engine/errors.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/commands/stored_result.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr double kShortestSitting = 0.001;  // [s]

class Clock {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

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

void remove_rows(const fs::path& rows) {
  fs::remove(rows);
  fs::remove(part_of(rows));
}

/// Whether the file is the finished group of this plan; a damaged one is computed again. Throws
/// StudyError if it is of another study.
bool is_finished(const fs::path& path, const StudyPlan& group, const TextPairs& provenance) {
  if (!is_there(path)) return false;
  ResultDescription stored;
  try {
    stored = describe_shard(path);
  } catch (const std::runtime_error&) {
    return false;
  }
  if (const auto differs = difference(describe(group, provenance), stored, path))
    throw StudyError(*differs + ", or begin anew with --force");
  return stored.sums && stored.sums->first_run == group.first_run &&
         stored.sums->last_run == group.last_run;
}

RunCounts counts_in(const fs::path& path) {
  const ResultFile file(path);
  RunCounts counts;
  for (const StoredCell& cell : file.cells()) counts += count_status(file, cell);
  return counts;
}

/// Runs one group, unless it is finished, and returns what has stopped it.
StopReason run_group(const StudyPlan& group, const fs::path& folder, const RunOptions& options,
                     std::optional<double> time_left, std::uint64_t& runs) {
  const fs::path sums = file_in(folder, "group", group.first_run);
  if (is_finished(sums, group, options.provenance)) return StopReason::complete;
  RunOptions of_group = options;
  of_group.output = file_in(folder, "rows", group.first_run);
  of_group.force = false;
  of_group.resume = !options.attempt;
  of_group.progress = ProgressStyle::none;
  if (time_left) of_group.time_budget = std::max(*time_left, kShortestSitting);
  const RunOutcome outcome = run_study(group, of_group);
  runs += outcome.runs_here;
  if (outcome.counts.missing > 0) return outcome.stopped;
  write_group(sums, of_group.output, sums_to_store(ResultFile(of_group.output), options.parallel));
  remove_rows(of_group.output);
  return StopReason::complete;
}

void show_progress(const StudyPlan& plan, std::uint64_t done, double seconds,
                   const RunOptions& options) {
  if (options.quiet || options.progress == ProgressStyle::none) return;
  std::fprintf(stderr, "montecarta: %llu of %llu runs after %.0f s\n",
               static_cast<unsigned long long>(done),
               static_cast<unsigned long long>(plan.runs_here()), seconds);
}

/// Begins or continues the work in the folder. Returns false if the result is complete already.
bool open_work(const fs::path& folder, const StudyPlan& plan, const RunOptions& options) {
  const bool goes_on = options.resume || options.attempt;
  if (options.force) fs::remove_all(folder);
  if (is_there(options.output) && goes_on) {
    const ResultDescription stored = describe_shard(options.output);
    const auto differs = difference(describe(plan, options.provenance), stored, options.output);
    if (differs) throw StudyError(*differs);
    return false;
  }
  if (!options.force) expect_free(options.output);
  if (is_there(folder) && !goes_on) {
    throw StudyError(folder.string() +
                     ": holds unfinished work: continue it with --resume, or start afresh with "
                     "--force");
  }
  fs::create_directories(folder);
  return true;
}

}  // namespace

fs::path groups_of(fs::path output) { return output += ".groups"; }

RunOutcome run_summed_study(const StudyPlan& plan, const RunOptions& options) {
  const Clock clock;
  const fs::path folder = groups_of(options.output);
  RunOutcome outcome;
  if (!open_work(folder, plan, options)) {
    outcome.counts = counts_in(options.output);
    return outcome;
  }
  std::vector<fs::path> groups;
  for (std::uint64_t run = plan.first_run; run < plan.last_run; run += kRunsOfAGroup) {
    const StudyPlan group = group_of(plan, run);
    std::optional<double> left = options.time_budget;
    if (left) *left -= clock.seconds();
    outcome.stopped = run_group(group, folder, options, left, outcome.runs_here);
    if (outcome.stopped != StopReason::complete) {
      outcome.counts.missing = (plan.last_run - run) * plan.cells.size();
      break;
    }
    groups.push_back(file_in(folder, "group", run));
    show_progress(plan, group.last_run - plan.first_run, clock.seconds(), options);
  }
  outcome.seconds = clock.seconds();
  if (outcome.stopped != StopReason::complete) return outcome;
  merge_groups(options.output, groups, plan.first_run, plan.last_run,
               options.force ? Existing::replace : Existing::refuse);
  fs::remove_all(folder);
  outcome.counts = counts_in(options.output);
  return outcome;
}

std::vector<NewGroup> computed_group(const StudyPlan& plan, std::uint64_t first_run,
                                     const fs::path& folder, const Parallel& parallel) {
  RunOptions options;
  options.output = file_in(folder, "rows", first_run);
  options.parallel = parallel;
  options.quiet = true;
  fs::create_directories(folder);
  const RunOutcome outcome = run_study(group_of(plan, first_run), options);
  std::vector<NewGroup> sums;
  if (outcome.counts.missing == 0) sums = sums_to_store(ResultFile(options.output), parallel);
  fs::remove_all(folder);
  if (sums.empty()) throw RunError(folder.string() + ": interrupted: call it again");
  return sums;
}

}  // namespace montecarta::experiments
