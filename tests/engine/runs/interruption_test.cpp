// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/interruption.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace montecarta::engine {
namespace {

TEST(Interruption, NotesTheFirstSignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Interruption interruption;
    EXPECT_EQ(interruption.signal(), 0);
    raise(signal);
    EXPECT_EQ(interruption.signal(), signal);
  }
}

TEST(Interruption, BeginsAfresh) {
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

}  // namespace
}  // namespace montecarta::engine
