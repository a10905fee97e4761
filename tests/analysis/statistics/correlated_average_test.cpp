// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/correlated_average.hpp"

#include "analysis/statistics/nees_bounds.hpp"
#include "engine/random/stream.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/exponential.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace montecarta::analysis {
namespace {

VectorSeries white(std::size_t dimension, std::size_t samples, double ratio = 1.0) {
  RngStream draw({.seed = 3, .purpose = Draw::test});
  VectorSeries series(dimension, std::vector<double>(samples));
  for (auto& component : series) {
    for (double& value : component) value = std::sqrt(ratio) * draw.normal();
  }
  return series;
}

VectorSeries constant(std::size_t dimension, std::size_t samples, double value) {
  return {dimension, std::vector<double>(samples, value)};
}

TEST(LagSums, KnowWhiteAndConstantSeriesAndOneComponentThatFollowsAnother) {
  EXPECT_NEAR(squared_correlations(white(3, 3000))[1], 0.0, 0.01);
  EXPECT_NEAR(semivariances(white(1, 3000))[0][7], 1.0, 0.1);
  EXPECT_GT(effective_samples(squared_correlations(white(3, 3000))), 2700.0);
  EXPECT_NEAR(squared_correlations(constant(2, 300, 0.7))[299], 1.0, 1e-9);
  EXPECT_EQ(semivariances(constant(1, 300, 0.7))[0][299], 0.0);
  EXPECT_NEAR(effective_samples(squared_correlations(constant(1, 300, 0.7))), 1.0, 1e-9);
  // u_b(t) = u_a(t - 5): no component goes together with itself.
  VectorSeries series = white(1, 3005);
  series.push_back(series.front());
  series[0].erase(series[0].begin(), series[0].begin() + 5);
  series[1].resize(3000);
  EXPECT_NEAR(squared_correlations(series)[5], 0.5, 0.05);
  EXPECT_NEAR(squared_correlations(series)[9], 0.0, 0.01);
}

TEST(CorrelatedAverage, OfWhiteErrorsIsThatOfIndependentFixesFromAbove) {
  const CorrelatedAverage found = correlated_average(white(3, 1000), 0.95);
  const Interval bounds = nees_bounds(1000, 3, 0.95);
  EXPECT_NEAR(found.mean, 1.0, 0.05);
  EXPECT_NEAR(found.mean / found.ratio.lower, bounds.upper / 3.0, 0.005);
  EXPECT_GT(found.ratio.upper, found.mean * 3.0 / bounds.lower)
      << "a slow error may have been small";
}

TEST(CorrelatedAverage, OfAConstantErrorKnowsOneSampleOnly) {
  const CorrelatedAverage found = correlated_average(constant(3, 1000, 1.0), 0.95);
  const Interval one = nees_bounds(1, 3, 0.95);
  EXPECT_NEAR(found.effective_samples, 1.0, 1e-9);
  EXPECT_NEAR(found.ratio.lower, 3.0 / one.upper, 1e-3);
  EXPECT_NEAR(found.ratio.upper, 3.0 / one.lower, 0.05 * 3.0 / one.lower);
}

TEST(CorrelatedAverage, IsInUnitsOfTheRatio) {
  const CorrelatedAverage one = correlated_average(white(3, 400), 0.95);
  const CorrelatedAverage four = correlated_average(white(3, 400, 4.0), 0.95);
  EXPECT_NEAR(four.ratio.lower, 4.0 * one.ratio.lower, 1e-6);
  EXPECT_NEAR(four.ratio.upper, 4.0 * one.ratio.upper, 1e-3);
  EXPECT_GT(four.ratio.lower, 1.0);
}

TEST(CorrelatedAverage, OneWildFixLeavesTheIntervalWide) {
  VectorSeries errors = white(3, 1000);
  errors[0][500] = 1000.0;
  const CorrelatedAverage found = correlated_average(errors, 0.95);
  EXPECT_LT(found.effective_samples, 2.0);
  EXPECT_LT(found.ratio.lower, 0.5 * found.mean);
}

TEST(SamplesThatDecide, GrowAsTheMarginShrinks) {
  const double wide = samples_that_decide(3, 0.95, 3.0), narrow = samples_that_decide(3, 0.95, 1.5);
  EXPECT_GT(wide, 20.0);
  EXPECT_LT(wide, narrow);
  // A lasting error of one component is small too often: 1.1 is beyond any drive.
  EXPECT_GT(samples_that_decide(1, 0.95, 1.1), 1e7);
}

TEST(WeightedSquares, OneWeightIsAChiSquare) {
  for (const double freedom : {1.0, 2.5, 3.0, 40.0}) {
    const boost::math::chi_squared law(freedom);
    const std::array<WeightedSquares, 1> terms = {{{0.5, freedom}}};
    for (const double share : {0.001, 0.025, 0.2, 0.5, 0.8, 0.975, 0.999}) {
      const double x = 0.5 * boost::math::quantile(law, share);
      EXPECT_NEAR(probability_below(terms, x), share, 0.01 * share + 0.007) << freedom;
    }
  }
}

// Chi-squares of 2 degrees are exponential: the difference of two exponentials gives the sum.
TEST(WeightedSquares, TwoWeightsKeepBothTails) {
  const std::array<WeightedSquares, 2> terms = {{{0.5, 2.0}, {0.05, 2.0}}};  // means 1 and 0.1
  const boost::math::exponential slow(1.0), fast(10.0);
  for (const double x : {0.02, 0.1, 1.1, 3.0, 5.0}) {
    const double exact = (10.0 * boost::math::cdf(slow, x) - 1.0 * boost::math::cdf(fast, x)) / 9.0;
    EXPECT_NEAR(probability_below(terms, x), exact, 0.05 * exact) << x;
  }
  EXPECT_EQ(probability_below(terms, 0.0), 0.0);
  EXPECT_NEAR(probability_below(terms, 1.1), probability_below(terms, 1.1 + 1e-6), 1e-4)
      << "continuous at the mean";
}

}  // namespace
}  // namespace montecarta::analysis
