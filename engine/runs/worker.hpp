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

namespace montecarta::engine {

/// What the workers of a session have in common.
struct Session {
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
  explicit Worker(const Session& session);
  void work();

 private:
  /// What a cell needs on this worker.
  struct CellState {
    CellState(const Cell& cell, const RecordLayout& layout, std::span<std::byte> memory);
    std::unique_ptr<SlamFilter> filter;
    RunRecord record;
    Recorder recorder;
  };

  void fetch_drive(std::size_t run_index);
  CellState& cell_state(std::size_t cell);
  void execute(const Task& task);

  const Session& session_;
  Drive drive_;
  std::optional<std::size_t> drive_run_index_;  ///< whose drive it is
  std::vector<std::byte> memory_;               ///< of one record, whichever cell's
  std::vector<std::unique_ptr<CellState>> cell_states_;
};

}  // namespace montecarta::engine
