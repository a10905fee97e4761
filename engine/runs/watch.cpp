// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/watch.hpp"

#include "engine/runs/monte_carlo.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace montecarta::engine {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kInterval = std::chrono::milliseconds(50);
constexpr double kLongestBudget = 1e9;  // [s], 31 years: beyond it the clock's ticks would overflow

std::optional<Clock::time_point> deadline_after(std::optional<double> seconds) {
  if (!seconds) return std::nullopt;
  const std::chrono::duration<double> budget(std::min(*seconds, kLongestBudget));
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(budget);
}

}  // namespace

Watch::Watch(const Orders& orders, StopRequest& stop, Progress& progress)
    : interruption_(orders.interruption),
      deadline_(deadline_after(orders.time_budget)),
      stop_(stop),
      progress_(progress),
      thread_([this] { keep_watch(); }) {}

Watch::~Watch() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  thread_.join();
  progress_.finish();
}

void Watch::keep_watch() {
  std::unique_lock lock(mutex_);
  while (!over_) {
    look();
    wake_.wait_for(lock, kInterval, [this] { return over_; });
  }
}

/// Closing the file may take seconds, in which a user would wonder whether Ctrl-C was heard.
void Watch::acknowledge_signal() const {
  if (interruption_.signal() == 0 || stop_.is_set()) return;
  std::fputs("\nmontecarta: stopping, what is done is kept", stderr);
  std::fputs(runs_under_scheduler() ? "\n" : " (a second signal ends it at once)\n", stderr);
}

void Watch::look() {
  acknowledge_signal();
  if (interruption_.signal() == SIGINT) stop_.make(StopReason::sigint);
  if (interruption_.signal() == SIGTERM) stop_.make(StopReason::sigterm);
  if (deadline_ && Clock::now() >= *deadline_) stop_.make(StopReason::time_budget);
  progress_.show();
}

}  // namespace montecarta::engine
