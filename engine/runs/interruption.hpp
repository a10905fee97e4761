// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/namespaces.hpp"

#include <atomic>
#include <csignal>
#include <cstdint>

namespace montecarta::engine {

/// Why a session of a study ended.
enum class StopReason : std::uint8_t {
  complete,     ///< nothing is missing
  time_budget,  ///< --time-budget is used up
  sigterm,
  sigint,
  error,  ///< an exception is on its way to the caller
};

/// Asks all workers to stop: they drop the run they are at and take no other. One relaxed load to
/// look.
class StopRequest final : public StopFlag {
 public:
  bool is_set() const override {
    return reason_.load(std::memory_order_relaxed) != StopReason::complete;
  }
  StopReason reason() const { return reason_.load(); }
  /// The first reason stays.
  void make(StopReason reason) {
    StopReason none = StopReason::complete;
    reason_.compare_exchange_strong(none, reason);
  }

 private:
  std::atomic<StopReason> reason_{StopReason::complete};
};

/// While one lives, the first SIGINT or SIGTERM is only noted, so that the program can close its
/// file; the second ends the program at once with exit code 128 + signal. A scheduler, unlike a
/// person, repeats itself: from it a second SIGTERM says nothing new. One at a time: signals belong
/// to the process.
class Interruption {
 public:
  enum class From { person, scheduler };
  explicit Interruption(From from = From::person);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// SIGINT, SIGTERM, or 0 where none has come since construction.
  int signal() const;

 private:
  struct sigaction before_int_ {};
  struct sigaction before_term_ {};
};

}  // namespace montecarta::engine
