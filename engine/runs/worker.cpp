// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/worker.hpp"

#include <algorithm>

namespace montecarta::engine {
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
  if (run_one(conditions, *here.filter, here.recorder, here.record) == RunEnd::dropped) return;
  session_.writer.write(task.cell, task.run_index, here.record);
  session_.progress.run_ended(here.record.status());
}

void Worker::fetch_drive(std::size_t run_index) {
  if (drive_run_index_ == run_index) return;
  drive_run_index_.reset();  // while it is half made it is nobody's
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
