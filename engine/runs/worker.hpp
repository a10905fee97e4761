// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/recorder.hpp"
#include "engine/records/result_writer.hpp"
#include "engine/runs/progress.hpp"
#include "engine/runs/run_one.hpp"
#include "engine/runs/task_list.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace montecarta {

/// What the workers of a sitting have in common.
struct Sitting {
  const StudyPlan& plan;
  std::span<const RecordLayout> layouts;  ///< one per cell
  ResultWriter& writer;
  TaskList& tasks;
  SpareThreads& spare_threads;
  StopRequest& stop;
  Progress& progress;
};

/// Takes tasks until none is left or it is asked to stop. Keeps its drive, its record and one
/// filter per cell from task to task: after the first run of each cell nothing allocates. For one
/// thread.
class Worker {
 public:
  explicit Worker(const Sitting& sitting);
  void work();

 private:
  /// What a cell needs on this worker.
  struct Station {
    Station(const Cell& cell, const RecordLayout& layout, std::span<std::byte> memory);
    std::unique_ptr<SlamFilter> filter;
    RunRecord record;
    Recorder recorder;
  };

  void fetch_drive(std::size_t run_index);
  Station& station(std::size_t cell);
  void execute(const Task& task);

  const Sitting& sitting_;
  Drive drive_;
  std::optional<std::size_t> drive_run_index_;  ///< whose drive it is
  std::vector<std::byte> memory_;               ///< of one record, whichever cell's
  std::vector<std::unique_ptr<Station>> stations_;
};

}  // namespace montecarta
