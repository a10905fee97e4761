// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/fitted_minimum.hpp"

#include "engine/errors.hpp"
#include "engine/namespaces.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace montecarta::analysis {
namespace {

/// Number of terms of a cubic polynomial of two variables.
constexpr int kTerms = 10;
using Terms = Eigen::Matrix<double, kTerms, 1>;
using TermsByVariable = Eigen::Matrix<double, kTerms, 2>;

Terms terms_at(double x, double y) {
  Terms terms;
  terms << 1.0, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
  return terms;
}

/// First derivatives of the terms by both variables.
TermsByVariable gradient_at(double x, double y) {
  TermsByVariable by;
  by.col(0) << 0.0, 1.0, 0.0, 2.0 * x, y, 0.0, 3.0 * x * x, 2.0 * x * y, y * y, 0.0;
  by.col(1) << 0.0, 0.0, 1.0, 0.0, x, 2.0 * y, 0.0, x * x, 2.0 * x * y, 3.0 * y * y;
  return by;
}

/// Second derivatives at a place of the polynomial with coefficients `c`.
Eigen::Matrix2d curvature_at(const Terms& c, double x, double y) {
  const double mixed = c[4] + 2.0 * (c[7] * x + c[8] * y);
  Eigen::Matrix2d curvature;
  curvature << 2.0 * c[3] + 6.0 * c[6] * x + 2.0 * c[7] * y, mixed, mixed,
      2.0 * c[5] + 2.0 * c[8] * x + 6.0 * c[9] * y;
  return curvature;
}

Eigen::Vector2d place_of(int row) {
  constexpr int kSide = 2 * kGridReach + 1;
  return {row / kSide - kGridReach, row % kSide - kGridReach};
}

/// {term, function} Coefficients of the fitted polynomials.
Eigen::MatrixXd fitted_terms(const Eigen::MatrixXd& values) {
  Eigen::MatrixXd design(kGridPlaces, kTerms);
  for (int row = 0; row < kGridPlaces; ++row) {
    const Eigen::Vector2d place = place_of(row);
    design.row(row) = terms_at(place.x(), place.y()).transpose();
  }
  return design.colPivHouseholderQr().solve(values);
}

/// The curvature with a unit in place of variables that are not free, so that it can be factored.
Eigen::Matrix2d of_free(Eigen::Matrix2d curvature, const std::array<bool, 2>& is_free) {
  for (int k = 0; k < 2; ++k) {
    if (is_free[static_cast<std::size_t>(k)]) continue;
    curvature.row(k).setZero();
    curvature.col(k).setZero();
    curvature(k, k) = 1.0;
  }
  return curvature;
}

/// Moves `place` to the minimum by Newton's method. Returns whether there is one within the grid.
bool find_minimum(const Terms& mean, const std::array<bool, 2>& is_free, Eigen::Vector2d& place) {
  constexpr int kMostSteps = 100;
  constexpr double kNear = 1e-10;
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::Vector2d slope = gradient_at(place.x(), place.y()).transpose() * mean;
    for (int k = 0; k < 2; ++k) slope[k] *= is_free[static_cast<std::size_t>(k)] ? 1.0 : 0.0;
    const Eigen::LLT<Eigen::Matrix2d> factor(
        of_free(curvature_at(mean, place.x(), place.y()), is_free));
    if (factor.info() != Eigen::Success) return false;
    const Eigen::Vector2d next = place - factor.solve(slope);
    if (next.cwiseAbs().maxCoeff() > kGridReach) return false;
    const bool is_near = (next - place).cwiseAbs().maxCoeff() < kNear;
    place = next;
    if (is_near) return true;
  }
  return false;
}

}  // namespace

FittedMinimum fitted_minimum(const Eigen::MatrixXd& values, const std::array<bool, 2>& is_free) {
  const auto n = static_cast<double>(values.cols());
  expect(values.rows() == kGridPlaces && n >= 2.0, "several functions on the whole grid");
  const Eigen::MatrixXd terms = fitted_terms(values);
  const Terms mean = terms.rowwise().mean();
  FittedMinimum found;
  found.is_minimum = find_minimum(mean, is_free, found.place);
  if (!found.is_minimum) {
    int least = 0;
    values.rowwise().mean().minCoeff(&least);
    found.place = place_of(least);
    return found;
  }
  const double x = found.place.x(), y = found.place.y();
  Eigen::MatrixXd slopes = gradient_at(x, y).transpose() * terms;
  slopes.colwise() -= Eigen::Vector2d(slopes.rowwise().mean());
  Eigen::Matrix2d spread = slopes * slopes.transpose() / (n * (n - 1.0));
  for (int k = 0; k < 2; ++k) {
    if (is_free[static_cast<std::size_t>(k)]) continue;
    spread.row(k).setZero();
    spread.col(k).setZero();
  }
  const Eigen::LLT<Eigen::Matrix2d> factor(of_free(curvature_at(mean, x, y), is_free));
  found.covariance = factor.solve(factor.solve(spread).transpose());
  return found;
}

}  // namespace montecarta::analysis
