// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/interruption.hpp"
#include "engine/runs/progress.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace montecarta::engine {

/// A thread of its own that looks twenty times a second whether a signal has come or the time
/// budget is used up, asks the workers to stop then, and shows progress, so that the workers need
/// no clock and no terminal.
class Watch {
 public:
  /// What may end a study early.
  struct Orders {
    const Interruption& interruption;
    std::optional<double> time_budget;  ///< [s] from the construction of the watch
  };

  /// What is referred to must outlive the watch.
  Watch(const Orders& orders, StopRequest& stop, Progress& progress);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  void keep_watch();
  void look();
  void acknowledge_signal() const;

  const Interruption& interruption_;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
  StopRequest& stop_;
  Progress& progress_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace montecarta::engine
