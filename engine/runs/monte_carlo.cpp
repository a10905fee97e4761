// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/monte_carlo.hpp"

#include "engine/core/unusable_filter.hpp"
#include "engine/errors.hpp"
#include "engine/runs/worker.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace montecarta::engine {

std::vector<std::uint64_t> rounds_of(const StudyPlan& plan) {
  if (plan.is_enough) return rounds_of(plan.runs_here());
  return {plan.runs_here()};
}

std::vector<std::uint64_t> rounds_of(std::uint64_t runs) {
  std::vector<std::uint64_t> rounds;
  for (std::uint64_t n = kFirstRound; n < runs; n *= 2) {
    rounds.push_back(n);
    if (n > runs / 2) break;  // 2 n may be beyond 64 bits
  }
  rounds.push_back(runs);
  return rounds;
}

namespace {

/// Spares the missing runs of a cell from `first` on, and returns their number.
std::uint64_t mark_not_needed(std::size_t cell, std::uint64_t first, std::uint64_t last,
                              ResultWriter& writer) {
  std::uint64_t not_needed = 0;
  for (std::uint64_t run = first; run < last; ++run) {
    if (writer.status(cell, run) != RunStatus::missing) continue;
    writer.spare(cell, run);
    ++not_needed;
  }
  return not_needed;
}

/// Called between rounds, when the first `runs` runs of every cell have ended. Spares the later
/// runs of each cell that has enough runs, and returns their number. If the study is killed
/// meanwhile, a later session decides the same, because only the first `runs` runs count.
std::uint64_t spare_what_is_enough(const StudyPlan& plan, std::uint64_t runs,
                                   const Parallel& parallel, ResultWriter& writer) {
  std::uint64_t not_needed = 0;
  for (std::size_t cell = 0; cell < plan.cells.size(); ++cell) {
    // An earlier session may have decided this, and been stopped before it had marked all runs.
    const bool known = writer.status(cell, runs) == RunStatus::not_needed;
    if (known || plan.is_enough(writer.unfinished(), cell, runs, parallel)) {
      not_needed += mark_not_needed(cell, runs, plan.runs_here(), writer);
    }
  }
  return not_needed;
}

constexpr int kSomeRunsFailed = 3;
constexpr int kCheckpoint = 85;

ResultWriter open_output(const StudyPlan& plan, const RunOptions& options) {
  if (options.attempt) return ResultWriter::attempt(options.output, plan, options.provenance);
  if (options.resume) return ResultWriter::resume(options.output, plan, options.provenance);
  return ResultWriter::create(options.output, plan, options.provenance,
                              options.force ? Existing::replace : Existing::refuse);
}

RunCounts stored_counts(const StudyPlan& plan, const ResultWriter& writer) {
  RunCounts counts;
  for (std::size_t cell = 0; cell < plan.cells.size(); ++cell) {
    for (std::size_t i = 0; i < plan.runs_here(); ++i) counts.add(writer.status(cell, i));
  }
  return counts;
}

/// Number of runs that are processed at the same time. OpenMP can distribute either the runs or the
/// loops inside them, so a few large runs are processed in sequence, each by all threads. TBB does
/// both at once.
std::size_t workers_for(const StudyPlan& plan, const Parallel& parallel, std::uint64_t missing) {
  const auto threads = static_cast<std::uint64_t>(parallel.threads());
  const bool all_large = std::ranges::all_of(
      plan.cells, [](const Cell& cell) { return cell.particles >= SpareThreads::kLeastParticles; });
  if (parallel.backend() == Backend::openmp && all_large && 2 * missing <= threads) return 1;
  return std::max<std::uint64_t>(1, std::min(threads, missing));
}

/// Runs one worker to its end. An exception stops the other workers and is thrown to the caller.
void run_worker(Session& session) {
  try {
    Worker(session).work();
  } catch (...) {
    session.stop.make(StopReason::error);
    throw;
  }
  session.spare_threads.gain_one();
}

/// Runs until no run is missing or a stop is requested.
void run_rounds(const StudyPlan& plan, const RunOptions& options, ResultWriter& writer,
                StopRequest& stop, Progress& progress) {
  const std::vector<RecordLayout> layouts = layouts_of(plan, Detail::usual);
  const std::vector<RecordLayout> full_layouts = layouts_of(plan, Detail::full);
  const std::size_t n_workers = workers_for(plan, options.parallel, progress.counts().missing);
  for (const std::uint64_t runs : rounds_of(plan)) {
    TaskList tasks(plan, runs, writer);
    SpareThreads spare(options.parallel, n_workers);
    Session session{plan, layouts, full_layouts, writer, tasks, spare, stop, progress};
    options.parallel.for_each(n_workers, [&](std::size_t) { run_worker(session); });
    if (stop.is_set()) return;
    if (runs == plan.runs_here()) return;
    progress.runs_ended(RunStatus::not_needed,
                        spare_what_is_enough(plan, runs, options.parallel, writer));
  }
}

/// Runs until no run is missing or a stop is requested. After an error, removes the file if this
/// session began it and no run has ended: nothing is lost, and the work does not stand in the way
/// of another study of that name. Failed runs are results, unless the filter is unusable.
void run_missing(const StudyPlan& plan, const RunOptions& options, ResultWriter& writer,
                 StopRequest& stop, Progress& progress) {
  const bool is_new = progress.counts().ended() == 0;
  try {
    run_rounds(plan, options, writer, stop, progress);
  } catch (const UnusableFilter&) {
    if (is_new && stored_counts(plan, writer).complete == 0) writer.discard();
    throw;
  } catch (...) {
    if (is_new && stored_counts(plan, writer).ended() == 0) writer.discard();
    throw;
  }
}

void close_output(ResultWriter& writer, const RunOutcome& outcome) {
  writer.note_wall_seconds(outcome.seconds);
  if (outcome.counts.missing == 0) return writer.finish();
  expect(outcome.stopped != StopReason::complete, "runs are missing though nobody asked to stop");
  writer.suspend();
}

}  // namespace

int exit_code(const RunOutcome& outcome, bool under_scheduler) {
  switch (outcome.stopped) {
    case StopReason::complete:
      return outcome.counts.failed > 0 ? kSomeRunsFailed : EXIT_SUCCESS;
    case StopReason::time_budget:
      return kCheckpoint;
    case StopReason::sigterm:
      return under_scheduler ? kCheckpoint : 128 + SIGTERM;
    case StopReason::sigint:
      return 128 + SIGINT;
    case StopReason::error:
      break;
  }
  expect(false, "an error has no outcome: it is thrown");
  return EXIT_FAILURE;
}

RunOutcome run_study(const StudyPlan& plan, const RunOptions& options) {
  const Stopwatch stopwatch;
  const Interruption interruption(runs_under_scheduler() ? Interruption::From::scheduler
                                                         : Interruption::From::person);
  ResultWriter writer = open_output(plan, options);
  for (const std::string& note : writer.notes()) {
    if (!options.quiet) std::fprintf(stderr, "%s\n", note.c_str());
  }
  const RunCounts before = stored_counts(plan, writer);
  StopRequest stop;
  if (before.missing > 0) {
    std::optional<double> left = options.time_budget;
    if (left) *left -= stopwatch.seconds();
    Progress progress(options.quiet ? ProgressStyle::none : options.progress, before);
    const Watch watch(interruption, left, stop, progress);
    run_missing(plan, options, writer, stop, progress);
  }
  RunOutcome outcome{.counts = stored_counts(plan, writer)};
  if (outcome.counts.missing > 0) outcome.stopped = stop.reason();
  outcome.runs_here = outcome.counts.ended() - before.ended();
  outcome.seconds = stopwatch.seconds();
  close_output(writer, outcome);
  outcome.signal = interruption.reason();
  return outcome;
}

}  // namespace montecarta::engine
