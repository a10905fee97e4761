// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/watch.hpp"

#include <gtest/gtest.h>

namespace montecarta::engine {
namespace {

using Clock = std::chrono::steady_clock;

/// Waits until somebody asks to stop; says why.
StopReason wait_for(const StopRequest& stop) {
  const auto give_up = Clock::now() + std::chrono::minutes(1);
  while (!stop.is_set() && Clock::now() < give_up) std::this_thread::yield();
  return stop.reason();
}

class WatchTest : public testing::Test {
 protected:
  Interruption interruption;
  StopRequest stop;
  Progress progress{ProgressStyle::none, {}};
};

TEST_F(WatchTest, AsksToStopWhenASignalComes) {
  const Watch watch({interruption, std::nullopt}, stop, progress);
  EXPECT_FALSE(stop.is_set());
  raise(SIGTERM);
  EXPECT_EQ(wait_for(stop), StopReason::sigterm);
}

TEST_F(WatchTest, AsksToStopWhenTheBudgetIsUsedUp) {
  const auto begin = Clock::now();
  const Watch watch({interruption, 0.1}, stop, progress);
  EXPECT_EQ(wait_for(stop), StopReason::time_budget);
  EXPECT_GE(Clock::now() - begin, std::chrono::milliseconds(100));
}

TEST_F(WatchTest, TakesABudgetLongerThanTheClockCanCount) {
  const Watch watch({interruption, 1e300}, stop, progress);
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  EXPECT_FALSE(stop.is_set());
}

}  // namespace
}  // namespace montecarta::engine
