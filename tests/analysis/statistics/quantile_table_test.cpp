// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/quantile_table.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace montecarta::analysis {
namespace {

TEST(QuantileTable, EqualsWhatSortingGivesToThreePercent) {
  RngStream draw({7, 0, 0, 0, Draw::test});
  for (const double spread : {0.1, 1.0, 5.0}) {
    QuantileTable table(2);
    std::vector<double> values;
    for (int i = 0; i < 301; ++i) {
      values.push_back(std::exp(spread * draw.normal()));
      table.add(1, values.back());
    }
    std::ranges::sort(values);
    EXPECT_NEAR(table.median(1), values[150], 0.03 * values[150]) << spread;
    const double middle = std::accumulate(values.begin() + 30, values.end() - 30, 0.0) / 241.0;
    EXPECT_NEAR(table.trimmed_mean(1, 30.0 / 301.0), middle, 0.03 * middle) << spread;
  }
}

TEST(QuantileTable, HoldsWhatIsOutOfItsRangeAtItsEnds) {
  QuantileTable table(3);
  table.add(0, 0.0);
  table.add(1, 1e300);
  EXPECT_LT(table.median(0), 1e-3);
  EXPECT_GT(table.median(1), 1e9);
  EXPECT_TRUE(std::isnan(table.median(2)));
  EXPECT_TRUE(std::isnan(table.trimmed_mean(2, 0.1)));
}

TEST(QuantileTable, DoesNotDependOnTheOrder) {
  QuantileTable forwards(1), backwards(1);
  for (int i = 1; i <= 50; ++i) forwards.add(0, i);
  for (int i = 50; i >= 1; --i) backwards.add(0, i);
  EXPECT_EQ(forwards.median(0), backwards.median(0));
  EXPECT_NEAR(forwards.median(0), 25.5, 0.8);
}

}  // namespace
}  // namespace montecarta::analysis
