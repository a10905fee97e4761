// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/nees.hpp"

#include <cmath>
#include <limits>
#include <optional>

namespace montecarta::analysis {
namespace {

constexpr double kLeastVarianceShare = 1e-10;
constexpr double kLeastPivot = 1e-12;
constexpr double kLargestAsymmetry = 1e-6;  // of the deviations: as six printed digits leave it

template <int D>
using Vec = Eigen::Matrix<double, D, 1>;
template <int D>
using Mat = Eigen::Matrix<double, D, D>;

/// e' P^-1 e by Cholesky of the correlation matrix, whose pivots do not depend on units; nullopt
/// where P is singular.
template <int D>
std::optional<double> quadratic_form(const Vec<D>& error, const Mat<D>& covariance,
                                     const Vec<D>& least_variance) {
  if (!(covariance.diagonal().array() > least_variance.array()).all()) return std::nullopt;
  const Vec<D> scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  Mat<D> L = Mat<D>::Zero(error.size(), error.size());
  double sum = 0.0;
  Vec<D> y(error.size());
  for (int i = 0; i < error.size(); ++i) {
    double rest = error(i) * scale(i);
    double pivot = 1.0;
    for (int j = 0; j < i; ++j) {
      double element = covariance(i, j) * scale(i) * scale(j);
      for (int k = 0; k < j; ++k) element -= L(i, k) * L(j, k);
      L(i, j) = element / L(j, j);
      pivot -= L(i, j) * L(i, j);
      rest -= L(i, j) * y(j);
    }
    if (!(pivot > kLeastPivot)) return std::nullopt;
    L(i, i) = std::sqrt(pivot);
    y(i) = rest / L(i, i);
    sum += y(i) * y(i);
  }
  return sum;
}

}  // namespace

template <int Dimension>
Nees nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance, int first) {
  const Vec<Dimension> e = error.template segment<Dimension>(first);
  Mat<Dimension> P = covariance.template block<Dimension, Dimension>(first, first);
  if (!e.allFinite() || !P.allFinite()) return {std::numeric_limits<double>::quiet_NaN(), false};
  const Vec<Dimension> floor = kNeesFloor.segment<Dimension>(first).cwiseAbs2();
  const Vec<Dimension> least = kLeastVarianceShare * floor;
  if (const auto value = quadratic_form<Dimension>(e, P, least)) return {*value, false};
  P.diagonal() += floor;
  const auto value = quadratic_form<Dimension>(e, P, least);
  return {value.value_or(std::numeric_limits<double>::quiet_NaN()), true};
}

double strict_nees(const Eigen::VectorXd& error, const Eigen::MatrixXd& P) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!error.allFinite() || !P.allFinite() || !(P.diagonal().array() > 0.0).all()) return kNone;
  const Eigen::VectorXd deviation = P.diagonal().cwiseSqrt();
  const Eigen::MatrixXd allowed = kLargestAsymmetry * deviation * deviation.transpose();
  if (((P - P.transpose()).cwiseAbs().array() > allowed.array()).any()) return kNone;
  const Eigen::VectorXd least = Eigen::VectorXd::Zero(error.size());
  return quadratic_form<Eigen::Dynamic>(error, P, least).value_or(kNone);
}

double ideal_spread_nees(std::size_t dimension, std::size_t particles) {
  if (particles <= dimension + 2) return std::numeric_limits<double>::infinity();
  const auto d = static_cast<double>(dimension), M = static_cast<double>(particles);
  return d * (M + 1.0) / (M - d - 2.0);
}

template Nees nees<1>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);
template Nees nees<2>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);
template Nees nees<3>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);

}  // namespace montecarta::analysis
