// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/distributions.hpp"

#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

// NIS that are 0, or beyond all reason, have a p-value as others do.
TEST(ChiSquaredTail, IsKnownFarFromTheFreedom) {
  for (const double freedom : {1.0, 2.0, 600.0, 1e5, 1e7}) {
    for (const double value : {0.0, 1e-300, 1e-12}) {
      EXPECT_NEAR(chi_squared_tail(value, freedom), 1.0, 1e-6) << value << " of " << freedom;
      EXPECT_NEAR(chi_squared_cdf(value, freedom), 0.0, 1e-6) << value << " of " << freedom;
    }
    EXPECT_EQ(chi_squared_tail(0.0, freedom), 1.0) << freedom;
    EXPECT_EQ(chi_squared_cdf(0.0, freedom), 0.0) << freedom;
    EXPECT_EQ(chi_squared_tail(1e300, freedom), 0.0) << freedom;
    EXPECT_EQ(chi_squared_cdf(1e300, freedom), 1.0) << freedom;
  }
}

}  // namespace
}  // namespace montecarta::analysis
