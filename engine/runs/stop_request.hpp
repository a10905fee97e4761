// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/step_context.hpp"

#include <atomic>
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

}  // namespace montecarta::engine
