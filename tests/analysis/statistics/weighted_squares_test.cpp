// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/correlated_average.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/exponential.hpp>
#include <gtest/gtest.h>

#include <array>

namespace montecarta::analysis {
namespace {

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
