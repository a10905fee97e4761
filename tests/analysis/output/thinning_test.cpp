// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/figure.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/random/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace montecarta::analysis {
namespace {

std::vector<double> counting(std::size_t n) {
  std::vector<double> times(n);
  std::iota(times.begin(), times.end(), 0.0);
  return times;
}

TEST(Thin, LeavesShortSeriesAlone) {
  const auto thinned = thin(counting(20), {{"a", "m", counting(20)}}, 10);
  EXPECT_EQ(thinned.times, counting(20));
  EXPECT_EQ(thinned.series[0].values, counting(20));
}

TEST(Thin, KeepsEveryExtremeInItsOrder) {
  RngStream draw({9, 0, 0, 0, Draw::test});
  std::vector<double> values(2173);
  for (double& value : values) value = draw.normal();
  values[777] = 1e6;
  values[1500] = -1e6;
  const auto thinned = thin(counting(2173), {{"a", "m", values}, {"b", "m", values}}, 300);
  EXPECT_EQ(thinned.times.size(), 600u);
  EXPECT_TRUE(std::ranges::is_sorted(thinned.times));
  for (const NamedSeries& one : thinned.series) {
    ASSERT_EQ(one.values.size(), 600u);
    const auto top = std::ranges::max_element(one.values);
    EXPECT_EQ(*top, 1e6);
    EXPECT_EQ(*std::ranges::min_element(one.values), -1e6);
    EXPECT_NEAR(thinned.times[static_cast<std::size_t>(top - one.values.begin())], 777.0, 8.0);
  }
}

TEST(Thin, KeepsGapsAndNumbersBesideThem) {
  std::vector<double> values(100, kNaN);
  values[7] = 4.0;
  const auto thinned = thin(counting(100), {{"a", "m", values}}, 10);
  EXPECT_EQ(thinned.series[0].values[0], 4.0);
  EXPECT_EQ(thinned.series[0].values[1], 4.0);
  EXPECT_TRUE(std::isnan(thinned.series[0].values[2]));
}

}  // namespace
}  // namespace montecarta::analysis
