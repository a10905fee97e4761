// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/map_scores.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace montecarta::analysis {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points drawn(std::size_t n, double size, RngStream& draw) {
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(size * draw.uniform(), size * draw.uniform());
  }
  return points;
}

/// The definition: over all ways to pair points of the smaller set with different points of the
/// larger one, where a pair farther than the cutoff is no pair.
double by_trying_all(Points few, Points many, double cutoff) {
  if (few.size() > many.size()) std::swap(few, many);
  std::vector<std::size_t> order(many.size());
  std::iota(order.begin(), order.end(), 0);
  double best = std::numeric_limits<double>::infinity();
  do {
    double sum = 0.5 * cutoff * cutoff * static_cast<double>(many.size() - few.size());
    for (std::size_t i = 0; i < few.size(); ++i) {
      sum += std::min((few[i] - many[order[i]]).squaredNorm(), cutoff * cutoff);
    }
    best = std::min(best, sum);
  } while (std::next_permutation(order.begin(), order.end()));
  return std::sqrt(best);
}

TEST(Gospa, EqualsTheBestOfAllAssignments) {
  RngStream draw({.seed = 11});
  for (int trial = 0; trial < 200; ++trial) {
    const Points map = drawn(draw.below(7), 15.0, draw), truth = drawn(draw.below(7), 15.0, draw);
    const Gospa found = gospa(map, truth);
    EXPECT_NEAR(found.distance, by_trying_all(map, truth, kGospaCutoff), 1e-12) << trial;
    EXPECT_NEAR(found.distance * found.distance,
                found.localisation * found.localisation + 12.5 * (found.missed + found.spurious),
                1e-9);
  }
}

TEST(Gospa, CountsWhatIsMissedAndWhatIsInvented) {
  const Points truth = {{0, 0}, {10, 0}, {20, 0}};
  const Gospa found = gospa(Points{{0.3, 0.4}, {10, 6}}, truth);
  EXPECT_DOUBLE_EQ(found.localisation, 0.5);
  EXPECT_EQ(found.missed, 2.0);
  EXPECT_EQ(found.spurious, 1.0);
  EXPECT_DOUBLE_EQ(found.distance, std::sqrt(0.25 + 3 * 12.5));
  EXPECT_EQ(gospa(truth, truth).distance, 0.0);
  EXPECT_EQ(gospa({}, truth).missed, 3.0);
  EXPECT_EQ(gospa(truth, {}).spurious, 3.0);
}

TEST(Gospa, GivesAPlaceThatIsNoNumberNoPartner) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Gospa found = gospa(Points{{nan, 0}}, Points{{0, 0}});
  EXPECT_EQ(found.missed, 1.0);
  EXPECT_EQ(found.spurious, 1.0);
}

// A greedy choice takes the pair of distance 0 first and pays 16 for the rest; the best pays 2 x 4.
TEST(Gospa, LooksAtTheWholeAndNotAtTheNearestPair) {
  const Gospa found = gospa(Points{{0, 0}, {2, 0}}, Points{{2, 0}, {4, 0}});
  EXPECT_DOUBLE_EQ(found.distance, std::sqrt(8.0));
}

}  // namespace
}  // namespace montecarta::analysis
