// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/worker.hpp"

#include "engine/errors.hpp"
#include "engine/runs/step.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <string_view>

namespace montecarta::engine {
namespace {

bool is_finite(const Pose& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.heading);
}

/// Describes the part of an estimate that is not finite; empty if all is finite or there is none.
std::string_view defect_of(const PoseEstimate* estimate) {
  if (estimate == nullptr) return {};
  if (!is_finite(estimate->spread.mean)) return "estimated pose is not finite";
  if (!estimate->spread.covariance.allFinite()) return "pose covariance is not finite";
  if (!estimate->mixture) return {};
  if (!is_finite(estimate->mixture->mean)) return "estimated pose (mixture) is not finite";
  if (!estimate->mixture->covariance.allFinite()) return "pose covariance (mixture) is not finite";
  return {};
}

void start(const RunConditions& conditions, SlamFilter& filter) {
  const StepContext context(conditions.seed, conditions.run, 0, Parallel::serial(),
                            &conditions.stop);
  start_filter(filter, context, {conditions.itinerary, conditions.drive});
}

/// Runs one step, with the scans from `scan` on that end it. Returns a description of the defect of
/// its estimate; empty if there is none.
std::string_view record_step(const RunConditions& conditions, const StepContext& context,
                             SlamFilter& filter, Recorder& recorder, std::size_t& scan) {
  const RunInput input{conditions.itinerary, conditions.drive};
  std::string_view flaw;
  const bool is_whole = take_step(filter, context, input, scan, [&](std::size_t now) {
    update_with_scan(filter, context, input, now);
    flaw = defect_of(recorder.after_scan(filter, now));
    return flaw.empty();
  });
  return is_whole ? defect_of(recorder.after_step(filter, context.step())) : flaw;
}

}  // namespace

RunEnd run_one(const RunConditions& conditions, SlamFilter& filter, Recorder& recorder,
               RunRecord& record) {
  record.clear();
  recorder.expect_scans(conditions.itinerary.scans());
  const CpuClock clock;
  const std::size_t particles = record.layout().particles();
  std::uint32_t step = 0;
  std::size_t scan = 0;
  try {
    start(conditions, filter);
    for (; step < conditions.itinerary.steps(); ++step) {
      if (conditions.stop.is_set()) return RunEnd::dropped;
      const StepContext context(conditions.seed, conditions.run, step,
                                conditions.spare_threads.lend(particles), &conditions.stop);
      const std::string_view flaw = record_step(conditions, context, filter, recorder, scan);
      if (flaw.empty()) continue;
      record.mark_failed(step, flaw, clock.seconds());
      return RunEnd::recorded;
    }
    record.mark_complete(clock.seconds());
  } catch (const std::bad_alloc&) {
    throw;  // a failure of the machine, not of the filter, is no result of the study
  } catch (const RunError&) {
    throw;  // also a failure of the machine
  } catch (const std::exception& error) {
    if (conditions.stop.is_set()) return RunEnd::dropped;  // the stop may have caused the exception
    record.mark_failed(step, error.what(), clock.seconds());
  } catch (...) {
    record.mark_failed(step, "an exception that is no std::exception", clock.seconds());
  }
  return RunEnd::recorded;
}

namespace {

std::size_t largest_record(std::span<const RecordLayout> layouts) {
  std::size_t largest = 0;
  for (const RecordLayout& layout : layouts) largest = std::max(largest, layout.bytes());
  return largest;
}

}  // namespace

bool are_runs_equal(const StudyPlan& plan, const Cell& cell) {
  const DriveSource& drives = *plan.drives;
  return cell.is_deterministic && !drives.itinerary().has_truth && drives.own_drives() == 0;
}

Worker::CellState::CellState(const Cell& cell, RunRecord&& memory)
    : filter(cell.make_filter()), record(std::move(memory)), recorder(record) {}

Worker::Worker(const Session& session)
    : session_(session),
      memory_(largest_record(session.layouts)),
      cell_states_(session.plan.cells.size()) {}

void Worker::work() {
  while (!session_.stop.is_set()) {
    const std::optional<Task> task = session_.tasks.take();
    if (!task) return;
    execute(*task);
  }
}

void Worker::execute(const Task& task) {
  fetch_drive(task.run_index);
  CellState& here = cell_state(task.cell);
  const StudyPlan& plan = session_.plan;
  const std::uint64_t run = plan.first_run + task.run_index;
  const RunConditions conditions{
      plan.seed,    run, plan.drives->itinerary_of(run), drive_, session_.spare_threads,
      session_.stop};
  if (run >= plan.columns.full_runs) {
    if (here.holds_every_run) return store(here.record, task);
    run_into(here.record, here.recorder, task, conditions);
    here.holds_every_run =
        are_runs_equal(plan, plan.cells[task.cell]) && here.record.status() != RunStatus::missing;
    return;
  }
  RunRecord record(session_.full_layouts[task.cell]);  // few runs need it, so it is not kept
  Recorder recorder(record);
  run_into(record, recorder, task, conditions);
}

void Worker::run_into(RunRecord& record, Recorder& recorder, const Task& task,
                      const RunConditions& conditions) {
  SlamFilter& filter = *cell_state(task.cell).filter;
  if (run_one(conditions, filter, recorder, record) == RunEnd::recorded) store(record, task);
}

void Worker::store(const RunRecord& record, const Task& task) {
  session_.writer.write(task.cell, task.run_index, record);
  session_.progress.runs_ended(record.status());
}

void Worker::fetch_drive(std::size_t run_index) {
  if (drive_run_index_ == run_index) return;
  drive_run_index_.reset();  // invalid until it is generated completely
  session_.plan.drives->generate(session_.plan.first_run + run_index, drive_);
  session_.writer.write_truth(run_index, drive_);
  drive_run_index_ = run_index;
}

Worker::CellState& Worker::cell_state(std::size_t cell) {
  std::unique_ptr<CellState>& place = cell_states_[cell];
  if (place) return *place;
  const Cell& planned = session_.plan.cells[cell];
  const RecordLayout& layout = session_.layouts[cell];
  place = are_runs_equal(session_.plan, planned)
              ? std::make_unique<CellState>(planned, RunRecord(layout))
              : std::make_unique<CellState>(planned, RunRecord(layout, memory_));
  return *place;
}

}  // namespace montecarta::engine
