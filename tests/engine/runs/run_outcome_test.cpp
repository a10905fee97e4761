// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/monte_carlo.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace montecarta::engine {
namespace {

RunOutcome stopped_by(StopReason reason) {
  return {.stopped = reason,
          .cells = {{.label = "a", .complete = 3, .failed = 1, .missing = 2},
                    {.label = "b", .complete = 4, .failed = 0, .missing = 2}}};
}

TEST(RunOutcome, SumsOverCells) {
  EXPECT_EQ(stopped_by(StopReason::sigint).failed(), 1U);
  EXPECT_EQ(stopped_by(StopReason::sigint).missing(), 4U);
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
