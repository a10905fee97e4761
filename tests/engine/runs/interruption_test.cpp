// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/interruption.hpp"

#include "engine/runs/monte_carlo.hpp"
#include "engine/runs/progress.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace montecarta::engine {
namespace {

TEST(Interruption, NotesTheFirstSignalAndBeginsAfresh) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Interruption interruption;
    EXPECT_EQ(interruption.signal(), 0);
    raise(signal);
    EXPECT_EQ(interruption.signal(), signal);
  }
  {
    const Interruption first;
    raise(SIGINT);
  }
  EXPECT_EQ(Interruption().signal(), 0);
}

TEST(Interruption, PutsBackWhatWasThere) {
  struct sigaction ignored {};
  ignored.sa_handler = SIG_IGN;
  struct sigaction before {};
  sigaction(SIGTERM, &ignored, &before);
  { const Interruption interruption; }
  struct sigaction after {};
  sigaction(SIGTERM, &before, &after);
  EXPECT_EQ(after.sa_handler, SIG_IGN);
}

TEST(Interruption, RefusesASecondOneAtATime) {
  const Interruption first;
  EXPECT_THROW(Interruption(), std::logic_error);
}

TEST(Interruption, ASchedulerMayRepeatItself) {
  const Interruption interruption(Interruption::From::scheduler);
  raise(SIGTERM);
  raise(SIGTERM);
  EXPECT_EQ(interruption.signal(), SIGTERM);
}

void be_signalled_twice(int signal) {
  const Interruption interruption;
  raise(signal);
  raise(signal);
}

TEST(InterruptionDeathTest, EndsAtOnceAtTheSecondSignal) {
  EXPECT_EXIT(be_signalled_twice(SIGINT), testing::ExitedWithCode(130), "");
  EXPECT_EXIT(be_signalled_twice(SIGTERM), testing::ExitedWithCode(143), "");
}

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
  const Watch watch(interruption, std::nullopt, stop, progress);
  EXPECT_FALSE(stop.is_set());
  raise(SIGTERM);
  EXPECT_EQ(wait_for(stop), StopReason::sigterm);
}

TEST_F(WatchTest, AsksToStopWhenTheBudgetIsUsedUp) {
  const auto begin = Clock::now();
  const Watch watch(interruption, 0.1, stop, progress);
  EXPECT_EQ(wait_for(stop), StopReason::time_budget);
  EXPECT_GE(Clock::now() - begin, std::chrono::milliseconds(100));
}

TEST_F(WatchTest, TakesABudgetLongerThanTheClockCanCount) {
  const Watch watch(interruption, 1e300, stop, progress);
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  EXPECT_FALSE(stop.is_set());
}

RunOutcome stopped_by(StopReason reason) {
  return {.stopped = reason, .counts = {.complete = 7, .failed = 1, .missing = 4}};
}

TEST(RunOutcome, HasTheExitCodesOfTheCommandLine) {
  EXPECT_EQ(exit_code({}, false), 0);
  EXPECT_EQ(exit_code(stopped_by(StopReason::complete), false), 3);
  EXPECT_EQ(exit_code(stopped_by(StopReason::time_budget), false), 85);
  EXPECT_EQ(exit_code(stopped_by(StopReason::sigterm), true), 85);
  EXPECT_EQ(exit_code(stopped_by(StopReason::sigterm), false), 143);
  EXPECT_EQ(exit_code(stopped_by(StopReason::sigint), true), 130);
  EXPECT_THROW(exit_code(stopped_by(StopReason::error), false), std::logic_error);
}

}  // namespace
}  // namespace montecarta::engine
