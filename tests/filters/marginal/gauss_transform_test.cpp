// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/gauss_transform.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

template <std::size_t D>
struct Clouds {
  std::vector<std::array<double, D>> sources, targets;
  std::vector<std::array<double, 2>> charges;

  Clouds(std::size_t n, double width, std::uint32_t seed) {
    RngStream draw({seed, 0, 0, 0, Draw::test});
    const auto place = [&] {
      std::array<double, D> x;
      for (double& value : x) value = width * draw.normal();
      return x;
    };
    for (std::size_t j = 0; j < n; ++j) {
      sources.push_back(place());
      targets.push_back(place());
      charges.push_back({draw.uniform(), draw.normal()});  // weights may be of either sign
    }
  }
  double direct(std::size_t i, std::size_t n) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < sources.size(); ++j) {
      double squared = 0.0;
      for (std::size_t d = 0; d < D; ++d) squared += std::pow(targets[i][d] - sources[j][d], 2);
      sum += charges[j][n] * std::exp(-squared);
    }
    return sum;
  }
  double total(std::size_t n) const {
    double sum = 0.0;
    for (const auto& charge : charges) sum += std::abs(charge[n]);
    return sum;
  }
};

template <std::size_t D>
void expect_bound(const GaussTransform<D, 2>& transform, const Clouds<D>& clouds,
                  double tolerance) {
  std::vector<double> scratch;
  for (std::size_t i = 0; i < clouds.targets.size(); ++i) {
    const auto sums = transform(clouds.targets[i], scratch);
    for (std::size_t n = 0; n < 2; ++n) {
      ASSERT_LE(std::abs(sums[n] - clouds.direct(i, n)), tolerance * clouds.total(n))
          << "d = " << D << ", tolerance " << tolerance << ", order " << transform.order();
    }
  }
}

template <std::size_t D>
int clouds_within_the_bound() {
  int n_transformed = 0;
  std::uint32_t seed = 0;
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-9}) {
    for (const double width : {0.05, 0.3, 1.0, 3.0}) {
      const Clouds<D> clouds(150, width, ++seed);
      GaussTransform<D, 2> transform;
      if (!transform.build(clouds.sources, clouds.charges, tolerance)) continue;
      EXPECT_LE(transform.clusters(), 75U);
      expect_bound(transform, clouds, tolerance);
      ++n_transformed;
    }
  }
  return n_transformed;
}

// EQUATIONS (13.3).
TEST(GaussTransform, ErrsByNoMoreThanItsBound) {
  EXPECT_GE(clouds_within_the_bound<1>(), 16);
  EXPECT_GE(clouds_within_the_bound<2>(), 10);
  EXPECT_GE(clouds_within_the_bound<3>(), 8);
}

TEST(GaussTransform, IsTheDirectSumWhereEverySourceIsACentre) {
  const Clouds<3> clouds(60, 1.0, 99);
  GaussTransform<3, 2> transform;
  ASSERT_TRUE(transform.build(clouds.sources, clouds.charges, 1e-300, 60));
  EXPECT_EQ(transform.order(), 1);
  expect_bound(transform, clouds, 1e-15);
}

TEST(GaussTransform, DeclinesSourcesThatAreTooScattered) {
  const Clouds<3> clouds(60, 100.0, 7);
  GaussTransform<3, 2> transform;
  EXPECT_FALSE(transform.build(clouds.sources, clouds.charges, 1e-6));
}

TEST(GaussTransform, MonomialsAreAllThatThereAre) {
  EXPECT_EQ(monomials_below<1>(7), 7U);
  EXPECT_EQ(monomials_below<3>(4), 20U);
  std::size_t count = 1;
  for_each_monomial<3>(4, [&](std::size_t, std::size_t parent, bool) {
    EXPECT_LT(parent, count);
    ++count;
  });
  EXPECT_EQ(count, 20U);
}

TEST(GaussTransform, LanesEqualOneTargetAtATime) {
  const Clouds<3> clouds(64, 0.4, 5);
  GaussTransform<3, 2> transform;
  ASSERT_TRUE(transform.build(clouds.sources, clouds.charges, 1e-6));
  std::vector<Lanes> lane_scratch;
  std::vector<double> scratch;
  std::array<Lanes, 3> eight;
  for (std::size_t l = 0; l < Lanes::kSize; ++l) {
    for (std::size_t d = 0; d < 3; ++d) set(eight[d], l, clouds.targets[l][d]);
  }
  const auto together = transform(eight, lane_scratch);
  for (std::size_t l = 0; l < Lanes::kSize; ++l)
    EXPECT_NEAR(get(together[0], l), transform(clouds.targets[l], scratch)[0], 1e-11);
}

TEST(FarthestPoints, CoverEveryPointAndShrinkBack) {
  const Clouds<2> clouds(100, 1.0, 3);
  FarthestPoints<2> points(clouds.sources);
  double before = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k <= 20; ++k) {
    ASSERT_TRUE(points.grow());
    EXPECT_LE(points.radius(), before);
    before = points.radius();
  }
  points.shrink(5);
  EXPECT_EQ(points.centres().size(), 5U);
  EXPECT_GE(points.radius(), before);
}

}  // namespace
}  // namespace montecarta::filters
