// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <array>

namespace montecarta::analysis {

/// The grid to which a surface is fitted: the whole numbers from -kGridReach to kGridReach in both
/// directions, of which the second one varies fastest.
inline constexpr int kGridReach = 2;
inline constexpr int kGridPlaces = (2 * kGridReach + 1) * (2 * kGridReach + 1);

/// The minimum of the mean of several functions of two variables (STATISTICS 23).
struct FittedMinimum {
  /// Place of the minimum, in steps of the grid from its centre. If the surface has no minimum
  /// within the grid, the place of the grid with the least mean.
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  /// Whether the surface has a minimum within the grid.
  bool is_minimum = false;
  /// Covariance of `place` if the functions are independent draws of one law; zero for variables
  /// that are not free. Needs no assumption about the law (sandwich).
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

/// Fits a cubic polynomial to each function by least squares, and finds the minimum of their mean.
/// `values` {kGridPlaces, function}; a variable that is not free stays at 0, and values must not
/// depend on it. There must be at least two functions.
FittedMinimum fitted_minimum(const Eigen::MatrixXd& values, const std::array<bool, 2>& is_free);

}  // namespace montecarta::analysis
