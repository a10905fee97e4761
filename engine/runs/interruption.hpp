// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/namespaces.hpp"

#include <atomic>
#include <csignal>
#include <cstdint>

namespace montecarta::engine {

/// The reason why a session of a study ended.
enum class StopReason : std::uint8_t {
  complete,     ///< no run is missing
  time_budget,  ///< --time-budget is exhausted
  sigterm,
  sigint,
  error,  ///< an exception is thrown to the caller
};

/// A request to all workers to stop: they drop their run and begin no other. A check costs one
/// relaxed load.
class StopRequest final : public StopFlag {
 public:
  bool is_set() const override {
    return reason_.load(std::memory_order_relaxed) != StopReason::complete;
  }
  StopReason reason() const { return reason_.load(); }
  /// Sets the reason, unless there is one already.
  void make(StopReason reason) {
    StopReason none = StopReason::complete;
    reason_.compare_exchange_strong(none, reason);
  }

 private:
  std::atomic<StopReason> reason_{StopReason::complete};
};

/// Returns whether a batch scheduler started this process (SLURM_JOB_ID is set). Its signals are
/// requests to stop, not interruptions.
bool runs_under_scheduler();

/// While the object exists, the first SIGINT or SIGTERM is only recorded, so that the program can
/// close its file. The second one ends the program at once with exit code 128 + signal, except that
/// a scheduler may repeat SIGTERM without effect. Only one object may exist, because signals belong
/// to the process.
class Interruption {
 public:
  enum class From { person, scheduler };
  explicit Interruption(From from = From::person);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// The signal, SIGINT or SIGTERM; 0 if none was received since construction.
  int signal() const;
  /// The signal as the reason to stop; StopReason::complete if none was received.
  StopReason reason() const;

 private:
  struct sigaction before_int_ {};
  struct sigaction before_term_ {};
};

}  // namespace montecarta::engine
