// SPDX-License-Identifier: BSD-3-Clause
#include "tests/filters/consistent_anees.hpp"

namespace montecarta::filters {
namespace {

TEST(IsConsistent, SaysInWhichDirectionAnAverageIsOff) {
  EXPECT_TRUE(is_consistent(3.1, 60));
  EXPECT_STREQ(is_consistent(1.3, 60).message(),
               "conservative: ANEES 1.30 where 3 is expected (1.68 to 4.86 over 60 runs)");
  EXPECT_FALSE(is_consistent(30.0, 60));
}

}  // namespace
}  // namespace montecarta::filters
