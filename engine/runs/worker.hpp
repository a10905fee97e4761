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

/// Processor time of the calling thread since construction. Reading it is a system call (measured:
/// 0.7 us), so it is read once per run, not once per step.
class CpuClock {
 public:
  CpuClock() : begin_(now()) {}
  /// [s] Processor time since construction.
  double seconds() const { return now() - begin_; }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  double begin_;
};

/// Everything besides the filter on which a run depends, and the resources that it may use.
struct RunConditions {
  std::uint64_t seed;  ///< seed of the study
  std::uint64_t run;
  const Itinerary& itinerary;
  const Drive& drive;  ///< drive of this run
  const SpareThreads& spare_threads;
  const StopRequest& stop;
};

enum class RunEnd { recorded, dropped };

/// Performs one run of `filter`, with its results recorded in `record` by `recorder`, which must
/// belong to it. The record is marked as complete or, if the filter throws or its estimate is not
/// finite, as failed with step and reason; rows after the failure stay NaN. If a stop is requested,
/// the run ends at the next step and the record is invalid (dropped).
[[nodiscard]] RunEnd run_one(const RunConditions& conditions, SlamFilter& filter,
                             Recorder& recorder, RunRecord& record);

/// One run of one cell, the unit of work.
struct Task {
  std::size_t run_index;  ///< index within the file
  std::size_t cell;
};

/// Distributes the tasks that are missing of the first `runs` runs of a file, run by run and within
/// a run cell by cell. Its only state is a counter, so that its memory does not grow with the
/// study.
class TaskList {
 public:
  TaskList(const StudyPlan& plan, std::uint64_t runs, const ResultWriter& writer)
      : n_cells_(plan.cells.size()), n_tasks_(runs * n_cells_), writer_(&writer) {}

  /// The next missing task; nullopt if there is none. Thread-safe.
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

/// Data that all workers of a session share.
struct Session {
  const StudyPlan& plan;
  /// {cell} layouts of usual runs, and of runs in full.
  std::span<const RecordLayout> layouts, full_layouts;
  ResultWriter& writer;
  TaskList& tasks;
  SpareThreads& spare_threads;
  StopRequest& stop;
  Progress& progress;
};

/// Returns whether all runs of a cell are the same: a filter without random numbers on one recorded
/// drive. A worker computes such a run once and writes its record for every run.
bool are_runs_equal(const StudyPlan& plan, const Cell& cell);

/// Processes tasks until none is left or a stop is requested. Keeps its drive, its record and one
/// filter per cell, so that nothing is allocated after the first run of each cell. For use by one
/// thread.
class Worker {
 public:
  explicit Worker(const Session& session);
  void work();

 private:
  /// The objects of a cell on this worker.
  struct CellState {
    CellState(const Cell& cell, RunRecord&& memory);
    std::unique_ptr<SlamFilter> filter;
    RunRecord record;
    Recorder recorder;
    bool holds_every_run = false;  ///< whether `record` is that of every run
  };

  void fetch_drive(std::size_t run_index);
  CellState& cell_state(std::size_t cell);
  void execute(const Task& task);
  void store(const RunRecord& record, const Task& task);
  void run_into(RunRecord& record, Recorder& recorder, const Task& task,
                const RunConditions& conditions);

  const Session& session_;
  Drive drive_;
  std::optional<std::size_t> drive_run_index_;  ///< run index of drive_; nullopt if it is invalid
  /// Memory of the record, which all cells share but those whose runs are all the same.
  std::vector<std::byte> memory_;
  std::vector<std::unique_ptr<CellState>> cell_states_;
};

}  // namespace montecarta::engine
