// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/worker.hpp"

#include "engine/errors.hpp"

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

/// The progress of a run from step to step.
class RunStepper {
 public:
  RunStepper(const RunConditions& conditions, SlamFilter& filter, Recorder& recorder,
             std::size_t particles)
      : conditions_(conditions), filter_(filter), recorder_(recorder), particles_(particles) {}

  void start() { filter_.start(conditions_.itinerary.start); }
  bool arrived() const { return step_ == conditions_.itinerary.steps(); }
  std::uint32_t step() const { return step_; }
  void next() { ++step_; }

  /// Runs one step. Returns a description of the defect of its estimate; empty if there is none.
  std::string_view take_step() {
    const Itinerary& itinerary = conditions_.itinerary;
    const StepContext context(conditions_.seed, conditions_.run, step_,
                              conditions_.spare_threads.lend(particles_), &conditions_.stop);
    const Control& control = conditions_.drive.controls[step_];
    if (!control.stands(itinerary.moving_controls))
      filter_.predict(context, control, itinerary.duration(step_));
    while (scan_ < itinerary.scans() && itinerary.scan_step[scan_] == step_) {
      filter_.update(context, conditions_.drive.scan(scan_));
      const std::string_view flaw = defect_of(recorder_.after_scan(filter_, scan_++));
      if (!flaw.empty()) return flaw;
    }
    return defect_of(recorder_.after_step(filter_, step_));
  }

 private:
  const RunConditions& conditions_;
  SlamFilter& filter_;
  Recorder& recorder_;
  std::size_t particles_;
  std::uint32_t step_ = 0;
  std::size_t scan_ = 0;
};

}  // namespace

RunEnd run_one(const RunConditions& conditions, SlamFilter& filter, Recorder& recorder,
               RunRecord& record) {
  record.clear();
  recorder.expect_scans(conditions.itinerary.scans());
  const CpuClock clock;
  RunStepper walk(conditions, filter, recorder, record.layout().particles());
  try {
    for (walk.start(); !walk.arrived(); walk.next()) {
      if (conditions.stop.is_set()) return RunEnd::dropped;
      const std::string_view flaw = walk.take_step();
      if (flaw.empty()) continue;
      record.mark_failed(walk.step(), flaw, clock.seconds());
      return RunEnd::recorded;
    }
    record.mark_complete(clock.seconds());
  } catch (const std::bad_alloc&) {
    throw;  // a failure of the machine, not of the filter, is no result of the study
  } catch (const RunError&) {
    throw;  // also a failure of the machine
  } catch (const std::exception& error) {
    if (conditions.stop.is_set()) return RunEnd::dropped;  // the stop may have caused the exception
    record.mark_failed(walk.step(), error.what(), clock.seconds());
  } catch (...) {
    record.mark_failed(walk.step(), "an exception that is no std::exception", clock.seconds());
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

Worker::CellState::CellState(const Cell& cell, const RecordLayout& layout,
                             std::span<std::byte> memory)
    : filter(cell.make_filter()), record(layout, memory), recorder(record) {}

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
  if (run >= plan.columns.full_runs) return run_into(here.record, here.recorder, task, conditions);
  RunRecord record(session_.full_layouts[task.cell]);  // few runs need it, so it is not kept
  Recorder recorder(record);
  run_into(record, recorder, task, conditions);
}

void Worker::run_into(RunRecord& record, Recorder& recorder, const Task& task,
                      const RunConditions& conditions) {
  SlamFilter& filter = *cell_state(task.cell).filter;
  if (run_one(conditions, filter, recorder, record) == RunEnd::dropped) return;
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
  if (!place)
    place = std::make_unique<CellState>(session_.plan.cells[cell], session_.layouts[cell], memory_);
  return *place;
}

}  // namespace montecarta::engine
