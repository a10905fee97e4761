// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/fitted_minimum.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace montecarta::analysis {
namespace {

using FunctionOfTwo = std::function<double(double, double)>;

/// The values of functions on the grid.
Eigen::MatrixXd grid_values_of(const std::vector<FunctionOfTwo>& functions) {
  Eigen::MatrixXd values(kGridPlaces, static_cast<Eigen::Index>(functions.size()));
  int row = 0;
  for (int i = -kGridReach; i <= kGridReach; ++i) {
    for (int j = -kGridReach; j <= kGridReach; ++j, ++row) {
      for (std::size_t k = 0; k < functions.size(); ++k)
        values(row, static_cast<Eigen::Index>(k)) = functions[k](i, j);
    }
  }
  return values;
}

/// A tilted bowl with its bottom at (a, b).
FunctionOfTwo bowl(double a, double b) {
  return [a, b](double x, double y) {
    return 2.0 * (x - a) * (x - a) + (x - a) * (y - b) + 3.0 * (y - b) * (y - b);
  };
}

TEST(FittedMinimum, IsTheMeanOfEqualBowlsWithTheCovarianceOfThatMean) {
  const FittedMinimum found = fitted_minimum(
      grid_values_of({bowl(0.1, -0.3), bowl(0.5, 0.1), bowl(0.3, 0.5)}), {true, true});
  ASSERT_TRUE(found.is_minimum);
  EXPECT_NEAR(found.place.x(), 0.3, 1e-9);
  EXPECT_NEAR(found.place.y(), 0.1, 1e-9);
  // Sample variances 0.04 and 0.16 and covariance 0.04, divided by three.
  EXPECT_NEAR(found.covariance(0, 0), 0.04 / 3.0, 1e-9);
  EXPECT_NEAR(found.covariance(1, 1), 0.16 / 3.0, 1e-9);
  EXPECT_NEAR(found.covariance(0, 1), 0.04 / 3.0, 1e-9);
}

TEST(FittedMinimum, FollowsCubicTerms) {
  const FunctionOfTwo skew = [](double x, double y) {
    return x * x + y * y - 0.3 * x - 0.1 * x * x * x + 0.05 * x * y * y;
  };
  const FittedMinimum found = fitted_minimum(grid_values_of({skew, skew}), {true, true});
  ASSERT_TRUE(found.is_minimum);
  // 2 x - 0.3 - 0.3 x^2 = 0 at y = 0.
  EXPECT_NEAR(found.place.x(), (2.0 - std::sqrt(4.0 - 0.36)) / 0.6, 1e-9);
  EXPECT_NEAR(found.place.y(), 0.0, 1e-9);
}

TEST(FittedMinimum, LeavesOutVariablesThatAreNotFree) {
  const auto along_x = [](double a) {
    return [a](double x, double /*y*/) { return (x - a) * (x - a); };
  };
  const FittedMinimum found =
      fitted_minimum(grid_values_of({along_x(0.2), along_x(0.6)}), {true, false});
  ASSERT_TRUE(found.is_minimum);
  EXPECT_NEAR(found.place.x(), 0.4, 1e-9);
  EXPECT_EQ(found.place.y(), 0.0);
  EXPECT_NEAR(found.covariance(0, 0), 0.08 / 2.0, 1e-9);
  EXPECT_EQ(found.covariance(1, 1), 0.0);
}

TEST(FittedMinimum, WithoutAMinimumIsTheLeastPlace) {
  const FunctionOfTwo slope = [](double x, double y) { return x + y * y; };
  const FunctionOfTwo saddle = [](double x, double y) { return x * x - y * y + 0.1 * y; };
  const FittedMinimum below = fitted_minimum(grid_values_of({slope, slope}), {true, true});
  EXPECT_FALSE(below.is_minimum);
  EXPECT_EQ(below.place, Eigen::Vector2d(-2.0, 0.0));
  EXPECT_FALSE(fitted_minimum(grid_values_of({saddle, saddle}), {true, true}).is_minimum);
}

}  // namespace
}  // namespace montecarta::analysis
