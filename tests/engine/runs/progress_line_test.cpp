// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/progress.hpp"

#include <gtest/gtest.h>

namespace montecarta::engine {
namespace {

TEST(ProgressLine, PutsDurationsInWords) {
  EXPECT_EQ(duration_in_words(0.2), "1 s");
  EXPECT_EQ(duration_in_words(59.0), "59 s");
  EXPECT_EQ(duration_in_words(59.5), "1:00 min");
  EXPECT_EQ(duration_in_words(185.0), "3:05 min");
  EXPECT_EQ(duration_in_words(3599.9), "1:00 h");
  EXPECT_EQ(duration_in_words(45600.0), "12:40 h");
  EXPECT_EQ(duration_in_words(293760.0), "3.4 d");
}

TEST(ProgressLine, TellsDoneFailedTotalRateAndTimeLeft) {
  EXPECT_EQ(progress_words({.done = 148, .failed = 2, .total = 300, .earlier = 50}, 10.0),
            "150/300 runs, 2 failed, 10/s, 15 s left");
}

TEST(ProgressLine, KnowsNoRateBeforeTheFirstRun) {
  EXPECT_EQ(progress_words({.done = 50, .total = 300, .earlier = 50}, 10.0), "50/300 runs");
}

TEST(ProgressLine, TellsTheTimeAtTheEnd) {
  EXPECT_EQ(progress_words({.done = 300, .total = 300}, 10.0), "300/300 runs, 30/s in 10 s");
}

TEST(ProgressLine, TellsSlowRatesByTheHour) {
  EXPECT_EQ(progress_words({.done = 1, .total = 2}, 600.0), "1/2 runs, 6/h, 10:00 min left");
}

TEST(ProgressLine, DrawsABarWhereItFits) {
  const RunCounts half{.done = 150, .total = 300};
  EXPECT_EQ(progress_bar(half, 10.0, 200),
            "[####################....................]  50 %  150/300 runs, 15/s, 10 s left");
  EXPECT_EQ(progress_bar(half, 10.0, 40), " 50 %  150/300 runs, 15/s, 10 s left");
}

TEST(ProgressLine, NeverExceedsTheWidth) {
  for (std::size_t width = 0; width < 120; ++width)
    EXPECT_LE(progress_bar({.done = 123, .failed = 7, .total = 1000}, 3.0, width).size(), width);
}

TEST(ProgressLine, ReachesAHundredPercentOnlyAtTheEnd) {
  EXPECT_EQ(progress_bar({.done = 9999, .total = 10000}, 1.0, 12), " 99 %  9999/");
}

}  // namespace
}  // namespace montecarta::engine
