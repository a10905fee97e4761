// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_writer.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace montecarta::engine {

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

}  // namespace montecarta::engine
