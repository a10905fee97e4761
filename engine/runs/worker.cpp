// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/worker.hpp"

#include <algorithm>

namespace montecarta {
namespace {

std::size_t largest_record(std::span<const RecordLayout> layouts) {
  std::size_t largest = 0;
  for (const RecordLayout& layout : layouts) largest = std::max(largest, layout.bytes());
  return largest;
}

}  // namespace

Worker::Station::Station(const Cell& cell, const RecordLayout& layout, std::span<std::byte> memory)
    : filter(cell.make_filter()), record(layout, memory), recorder(record) {}

Worker::Worker(const Sitting& sitting)
    : sitting_(sitting),
      memory_(largest_record(sitting.layouts)),
      stations_(sitting.plan.cells.size()) {}

void Worker::work() {
  while (!sitting_.stop.made()) {
    const std::optional<Task> task = sitting_.tasks.take();
    if (!task) return;
    execute(*task);
  }
}

void Worker::execute(const Task& task) {
  fetch_drive(task.run_index);
  Station& here = station(task.cell);
  const StudyPlan& plan = sitting_.plan;
  const RunConditions conditions{
      plan.seed, plan.first_run + task.run_index, plan.drives->itinerary(),
      drive_,    sitting_.spare_threads,          sitting_.stop};
  if (run_one(conditions, *here.filter, here.recorder, here.record) == RunEnd::dropped) return;
  sitting_.writer.write(task.cell, task.run_index, here.record);
  sitting_.progress.run_ended(here.record.status());
}

void Worker::fetch_drive(std::size_t run_index) {
  if (drive_run_index_ == run_index) return;
  drive_run_index_.reset();  // while it is half made it is nobody's
  sitting_.plan.drives->generate(sitting_.plan.first_run + run_index, drive_);
  sitting_.writer.write_truth(run_index, drive_);
  drive_run_index_ = run_index;
}

Worker::Station& Worker::station(std::size_t cell) {
  std::unique_ptr<Station>& place = stations_[cell];
  if (!place)
    place = std::make_unique<Station>(sitting_.plan.cells[cell], sitting_.layouts[cell], memory_);
  return *place;
}

}  // namespace montecarta
