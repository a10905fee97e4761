// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/study/make_plan.hpp"

#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

TEST(RunRange, IsHalfOpen) {
  EXPECT_EQ(parse_run_range("3:7", 20).first, 3U);
  EXPECT_EQ(parse_run_range("3:7", 20).last, 7U);
  EXPECT_EQ(parse_run_range(":7", 20).first, 0U);
  EXPECT_EQ(parse_run_range("3:", 20).last, 20U);
  for (const char* bad : {"", "3", "7:3", "3:3", "0:21", "-1:4", "1:2:3", "a:b"}) {
    EXPECT_THROW(parse_run_range(bad, 20), StudyError) << bad;
  }
}

TEST(Shards, FollowEachOtherWithoutGaps) {
  for (const std::uint64_t runs : {4U, 7U, 40U, 10'000'000U}) {
    std::uint64_t next = 0;
    for (int i = 0; i < 4; ++i) {
      const RunRange shard = parse_shard(std::to_string(i) + "/4", runs);
      EXPECT_EQ(shard.first, next);
      EXPECT_GT(shard.last, shard.first);
      next = shard.last;
    }
    EXPECT_EQ(next, runs);
  }
  for (const char* bad : {"", "1", "4/4", "0/0", "0/8", "-1/4", "a/b", "0/4/1"}) {
    EXPECT_THROW(parse_shard(bad, 7), StudyError) << bad;
  }
}

}  // namespace
}  // namespace montecarta::experiments
