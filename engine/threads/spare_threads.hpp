// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/threads/parallel.hpp"

#include <atomic>
#include <cstddef>

namespace montecarta::engine {

/// Gives the threads that have no run of their own to the loops inside the runs still at work:
/// where runs are fewer than threads, and at the end of every study.
class SpareThreads {
 public:
  /// Below this many particles a loop over them costs more to spread than it saves.
  static constexpr std::size_t kLeastParticles = 256;

  SpareThreads(const Parallel& parallel, std::size_t workers)
      : parallel_(&parallel), at_work_(workers) {}

  /// How the next loop over `particles` is to be spread: changes from step to step, results do not.
  const Parallel& lend(std::size_t particles) const {
    const auto threads = static_cast<std::size_t>(parallel_->threads());
    const bool spare = at_work_.load(std::memory_order_relaxed) < threads;
    return spare && particles >= kLeastParticles ? *parallel_ : Parallel::serial();
  }
  /// A worker has found nothing more to do.
  void gain_one() { at_work_.fetch_sub(1, std::memory_order_relaxed); }

 private:
  const Parallel* parallel_;
  std::atomic<std::size_t> at_work_;
};

}  // namespace montecarta::engine
