// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/step_context.hpp"
#include "engine/numbers/real.hpp"

#include <algorithm>
#include <cstddef>

namespace montecarta::engine {

/// The blocks of a population shared out to tasks that may run at once.
template <class Real>
class BlockTasks {
 public:
  /// `per_task` blocks: fewer than 256 particles of usual work do not pay for a thread.
  explicit BlockTasks(std::size_t blocks, std::size_t per_task = 256 / kLanesOf<Real>)
      : blocks_(blocks), per_task_(per_task) {}

  std::size_t count() const { return (blocks_ + per_task_ - 1) / per_task_; }

  /// Calls body(task, block) for every block, those of a task in order.
  template <class Body>
  void run(const StepContext& context, const Body& body) const {
    context.parallel_for(count(), [&](std::size_t task) {
      const std::size_t end = std::min(blocks_, (task + 1) * per_task_);
      for (std::size_t b = task * per_task_; b < end; ++b) body(task, b);
    });
  }

 private:
  std::size_t blocks_, per_task_;
};

}  // namespace montecarta::engine
