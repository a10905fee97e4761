// SPDX-License-Identifier: BSD-3-Clause
#include "engine/text/number_text.hpp"

#include <gtest/gtest.h>

namespace montecarta::engine {
namespace {

TEST(DurationText, IsShort) {
  EXPECT_EQ(duration_text(0.2), "0.2 s");
  EXPECT_EQ(duration_text(0.01), "0.1 s") << "while runs are left, time is left";
  EXPECT_EQ(duration_text(4.21), "4.3 s");
  EXPECT_EQ(duration_text(9.9), "9.9 s");
  EXPECT_EQ(duration_text(9.91), "10 s");
  EXPECT_EQ(duration_text(59.0), "59 s");
  EXPECT_EQ(duration_text(59.5), "1:00 min");
  EXPECT_EQ(duration_text(185.0), "3:05 min");
  EXPECT_EQ(duration_text(3599.9), "1:00 h");
  EXPECT_EQ(duration_text(45600.0), "12:40 h");
  EXPECT_EQ(duration_text(293760.0), "3.4 d");
}

}  // namespace
}  // namespace montecarta::engine
