// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/plan.hpp"
#include "engine/core/slam_filter.hpp"
#include "engine/namespaces.hpp"
#include "engine/records/recorder.hpp"
#include "engine/records/result_writer.hpp"
#include "engine/records/run_record.hpp"
#include "engine/runs/interruption.hpp"
#include "engine/runs/progress.hpp"
#include "engine/threads/parallel.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::engine {

/// Processor time of the calling thread since construction. A system call (0.7 us where measured),
/// so it is read once a run, not once a step.
class CpuClock {
 public:
  CpuClock() : begin_(now()) {}
  /// [s]
  double seconds() const { return now() - begin_; }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double begin_;
};

/// All that a run depends on besides its filter, and what it may use meanwhile.
struct RunConditions {
  std::uint64_t seed;  ///< of the study
  std::uint64_t run;
  const Itinerary& itinerary;
  const Drive& drive;  ///< of this run
  const SpareThreads& spare_threads;
  const StopRequest& stop;
};

enum class RunEnd { recorded, dropped };

/// Takes `filter` through one run and leaves what `recorder` saw in `record`, marked complete or,
/// where the filter threw or its estimate was not finite, failed with step and reason; rows behind
/// the failure stay NaN. Stops at the next step when asked to: the record then is worthless
/// (dropped). `recorder` belongs to `record`.
[[nodiscard]] RunEnd run_one(const RunConditions& conditions, SlamFilter& filter,
                             Recorder& recorder, RunRecord& record);

/// One run of one cell: the unit of work.
struct Task {
  std::size_t run_index;  ///< within the file
  std::size_t cell;
};

/// The tasks a file still misses of its first `runs` runs, run by run and within a run cell by
/// cell, handed out one at a time. Holds nothing but a counter: its memory does not grow with the
/// study.
class TaskList {
 public:
  TaskList(const StudyPlan& plan, std::uint64_t runs, const ResultWriter& writer)
      : n_cells_(plan.cells.size()), n_tasks_(runs * n_cells_), writer_(&writer) {}

  /// The next missing task, nullopt where there is none. Thread-safe.
  std::optional<Task> take() {
    for (;;) {
      const std::uint64_t index = next_.fetch_add(1, std::memory_order_relaxed);
      if (index >= n_tasks_) return std::nullopt;
      const Task task{index / n_cells_, index % n_cells_};
      if (writer_->status(task.cell, task.run_index) == RunStatus::missing) return task;
    }
  }

 private:
  std::uint64_t n_cells_;
  std::uint64_t n_tasks_;
  const ResultWriter* writer_;
  std::atomic<std::uint64_t> next_{0};
};

/// What the workers of a session have in common.
struct Session {
  const StudyPlan& plan;
  std::span<const RecordLayout> layouts, full_layouts;  ///< one per cell
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
  void run_into(RunRecord& record, Recorder& recorder, const Task& task,
                const RunConditions& conditions);

  const Session& session_;
  Drive drive_;
  std::optional<std::size_t> drive_run_index_;  ///< whose drive it is
  std::vector<std::byte> memory_;               ///< of one record, whichever cell's
  std::vector<std::unique_ptr<CellState>> cell_states_;
};

}  // namespace montecarta::engine
