// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/spread.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

// 1, 2, 3: sd 1, standard error 1 / sqrt 3, and 4.302652730 is the 97.5 % quantile of t with 2.
TEST(Summary, HasStudentsInterval) {
  EXPECT_NEAR(summary_of(std::vector{1.0, 2.0, 3.0}).half_width(0.95),
              4.302652729911275 / std::sqrt(3.0), 1e-9);
  EXPECT_TRUE(std::isnan(summary_of(std::vector{1.0}).half_width(0.95)));
  EXPECT_TRUE(std::isnan(summary_of(std::vector{1.0, kNaN, 2.0}).half_width(0.95)));
}

}  // namespace
}  // namespace montecarta::analysis
