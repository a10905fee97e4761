// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/nees.hpp"

#include "analysis/statistics/spread.hpp"

#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace montecarta::analysis {

bool is_drawn(const RunRows& rows, std::size_t s) {
  const std::vector<double>&spread = rows.spread.covariance, &mixture = rows.mixture.covariance;
  if (mixture.empty()) return true;
  const auto first = static_cast<std::ptrdiff_t>(9 * s);
  return !std::equal(spread.begin() + first, spread.begin() + first + 9, mixture.begin() + first);
}

EffectiveDraws draws_at(const RunRows& rows, std::size_t particles, std::size_t s) {
  return effective_draws(particles,
                         rows.ess.empty() ? static_cast<double>(particles) : rows.ess[s]);
}

namespace {

constexpr double kLeastPivot = 1e-12;       // also the least eigenvalue that counts in the rank
constexpr double kMostNegative = -1e-9;     // eigenvalue that rounding may leave
constexpr double kRounding = 1e-9;          // error of a component that is known exactly
constexpr double kFarthestOutside = 10.0;   // standard deviations; second-order effects are smaller
constexpr double kLargestAsymmetry = 1e-6;  // of the deviations: as six printed digits leave it
constexpr double kLastTail = 1e-6;          // beyond, a consistent filter hardly ever is
constexpr double kLargestError = 1e30;      // in deviations; its square is kLargestNees
const Eigen::Vector3d kLeastDeviation{1e-9, 1e-9, 1e-10};

template <int D>
using Vec = Eigen::Matrix<double, D, 1>;
template <int D>
using Mat = Eigen::Matrix<double, D, D>;

double capped(double nees) { return nees <= kLargestNees ? nees : kLargestNees; }

/// L^-1 e with P = L L', by Cholesky of the correlation matrix, so that the pivots are independent
/// of units; nullopt if P is singular. Writes the determinant of P if `determinant` is given.
template <int D>
std::optional<Vec<D>> whitened(const Vec<D>& error, const Mat<D>& covariance,
                               const Vec<D>& least_variance, double* determinant = nullptr) {
  if (!(covariance.diagonal().array() > least_variance.array()).all()) return std::nullopt;
  const Vec<D> scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  Mat<D> L = Mat<D>::Zero(error.size(), error.size());
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
    L(i, i) = i == 0 ? 1.0 : std::sqrt(pivot);
    y(i) = rest / L(i, i);
  }
  if (determinant != nullptr) {
    *determinant = covariance.diagonal().prod() * L.diagonal().cwiseAbs2().prod();
  }
  return y;
}

/// e' P^-1 e; nullopt if P is singular.
template <int D>
std::optional<double> quadratic_form(const Vec<D>& error, const Mat<D>& covariance,
                                     const Vec<D>& least_variance) {
  const std::optional<Vec<D>> y = whitened<D>(error, covariance, least_variance);
  if (!y) return std::nullopt;
  double sum = 0.0;
  for (int i = 0; i < y->size(); ++i) sum += (*y)(i) * (*y)(i);
  return sum;
}

constexpr Nees kUnusableSample = {kNaN, Nees::kUnusable};

/// Components of an error, sorted by their variances.
struct Components {
  std::vector<Eigen::Index> open;  ///< of a variance above the least
  bool is_excluded = false;        ///< one that is known exactly has an error of more than rounding
};

/// nullopt if a variance is negative, or a covariance larger than two variances allow.
std::optional<Components> open_components(const Eigen::VectorXd& error, const Eigen::MatrixXd& P,
                                          const Eigen::VectorXd& least_variance) {
  Components found;
  for (Eigen::Index i = 0; i < error.size(); ++i) {
    if (P(i, i) > least_variance(i)) {
      found.open.push_back(i);
      continue;
    }
    if (P(i, i) < -least_variance(i)) return std::nullopt;
    found.is_excluded = found.is_excluded || std::abs(error(i)) > kRounding;
    for (Eigen::Index j = 0; j < error.size(); ++j) {
      const double most = std::max(P(j, j), least_variance(j)) * least_variance(i);
      const double covariance = P(std::max(i, j), std::min(i, j));
      if (i != j && covariance * covariance > most) return std::nullopt;
    }
  }
  return found;
}

/// NEES in the range of a singular P. An error that P excludes has the largest NEES: if a component
/// that is known exactly has an error of more than rounding, or if the error is farther outside the
/// range than second-order effects explain.
Nees nees_in_range(const Eigen::VectorXd& error, const Eigen::MatrixXd& P,
                   const Eigen::VectorXd& least_variance) {
  const std::optional<Components> components = open_components(error, P, least_variance);
  if (!components) return kUnusableSample;
  const auto& [open, is_excluded] = *components;
  if (open.empty()) return is_excluded ? Nees{kLargestNees, 1} : Nees{kNaN, 0};
  const Eigen::MatrixXd block = P(open, open);
  const Eigen::VectorXd scale = block.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * block * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation);
  const Eigen::VectorXd along = solver.eigenvectors().transpose() * scale.cwiseProduct(error(open));
  Nees sample = {0.0, 0};
  double outside = 0.0;
  for (Eigen::Index k = 0; k < along.size(); ++k) {
    const double eigenvalue = solver.eigenvalues()(k);
    if (!(eigenvalue >= kMostNegative)) return kUnusableSample;
    if (eigenvalue > kLeastPivot) {
      sample.value += along(k) * along(k) / eigenvalue;
      ++sample.rank;
    } else {
      outside += along(k) * along(k);
    }
  }
  const bool is_far_outside = !(outside <= kFarthestOutside * kFarthestOutside);
  sample.value = is_excluded || is_far_outside ? kLargestNees : capped(sample.value);
  return sample;
}

}  // namespace

template <int Dimension>
Nees nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance, int first) {
  const Vec<Dimension> e = error.template segment<Dimension>(first);
  const Mat<Dimension> P = covariance.template block<Dimension, Dimension>(first, first);
  if (!e.allFinite() || !P.allFinite()) return kUnusableSample;
  const Vec<Dimension> least = kLeastDeviation.segment<Dimension>(first).cwiseAbs2();
  if (const auto value = quadratic_form<Dimension>(e, P, least)) {
    return {capped(*value), Dimension};
  }
  return nees_in_range(e, P, least);
}

std::array<Nees, kErrorBlocks.size()> pose_nees(const Eigen::Vector3d& error,
                                                const Eigen::Matrix3d& covariance) {
  const Nees heading = nees<1>(error, covariance, 2);
  const bool is_finite = error.allFinite() && covariance.allFinite();
  const auto y =
      is_finite ? whitened<3>(error, covariance, kLeastDeviation.cwiseAbs2()) : std::nullopt;
  if (!y) return {nees<3>(error, covariance), nees<2>(error, covariance), heading};
  const double position = (*y)(0) * (*y)(0) + (*y)(1) * (*y)(1);
  return {Nees{capped(position + (*y)(2) * (*y)(2)), 3}, Nees{capped(position), 2}, heading};
}

double negative_log_density(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  if (!error.allFinite() || !covariance.allFinite()) return kNaN;
  double determinant = 0.0;
  const auto y = whitened<3>(error, covariance, kLeastDeviation.cwiseAbs2(), &determinant);
  if (!y) return kNaN;
  return 0.5 * (3.0 * std::log(2.0 * std::numbers::pi) + std::log(determinant) +
                capped((*y)(0) * (*y)(0) + (*y)(1) * (*y)(1) + (*y)(2) * (*y)(2)));
}

Nees imported_nees(const Eigen::VectorXd& error, const Eigen::MatrixXd& P) {
  if (!error.allFinite() || !P.allFinite() || (P.diagonal().array() < 0.0).any()) {
    return kUnusableSample;
  }
  const Eigen::VectorXd deviation = P.diagonal().cwiseSqrt();
  const Eigen::MatrixXd allowed = kLargestAsymmetry * deviation * deviation.transpose();
  if (((P - P.transpose()).cwiseAbs().array() > allowed.array()).any()) return kUnusableSample;
  const Eigen::VectorXd least = Eigen::VectorXd::Zero(error.size());
  if (const auto value = quadratic_form<Eigen::Dynamic>(error, P, least)) {
    return {capped(*value), static_cast<int>(error.size())};
  }
  return nees_in_range(error, P, least);
}

std::size_t whiten_pose(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                        std::span<double> whitened_error, std::span<double> standardised) {
  const Eigen::Vector3d least = kLeastDeviation.cwiseAbs2();
  const bool is_finite = error.allFinite() && covariance.allFinite();
  const auto y = is_finite ? whitened<3>(error, covariance, least) : std::nullopt;
  if (!y || y->cwiseAbs().maxCoeff() > kLargestError) {
    return whiten(error, covariance, kLeastDeviation, whitened_error, standardised);
  }
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto component = static_cast<std::size_t>(k);
    whitened_error[component] = (*y)(k);
    standardised[component] =
        std::clamp(error(k) / std::sqrt(covariance(k, k)), -kLargestError, kLargestError);
  }
  return 3;
}

std::size_t whiten(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance,
                   const Eigen::VectorXd& least_deviation, std::span<double> whitened_error,
                   std::span<double> standardised) {
  std::ranges::fill(whitened_error, kNaN);
  std::ranges::fill(standardised, kNaN);
  if (!error.allFinite() || !covariance.allFinite()) return 0;
  const Eigen::VectorXd least = least_deviation.cwiseAbs2();
  std::vector<Eigen::Index> open;
  for (Eigen::Index i = 0; i < error.size(); ++i) {
    if (covariance(i, i) > least(i)) open.push_back(i);
  }
  const auto y = whitened<Eigen::Dynamic>(error(open), covariance(open, open), least(open));
  if (!y) return 0;
  const double largest = open.empty() ? 0.0 : y->cwiseAbs().maxCoeff();
  const double scale = largest > kLargestError ? kLargestError / largest : 1.0;
  for (std::size_t k = 0; k < open.size(); ++k) {
    const auto component = static_cast<std::size_t>(open[k]);
    const double by_deviation = error(open[k]) / std::sqrt(covariance(open[k], open[k]));
    whitened_error[component] = scale * (*y)(static_cast<Eigen::Index>(k));
    standardised[component] = std::clamp(by_deviation, -kLargestError, kLargestError);
  }
  return open.size();
}

double on_full_scale(const Nees& sample, std::size_t dimension) {
  if (sample.rank <= 0) return kNaN;
  if (static_cast<std::size_t>(sample.rank) == dimension || sample.value == 0.0) {
    return sample.value;
  }
  const boost::math::chi_squared in_range(sample.rank), full(static_cast<double>(dimension));
  const auto value_beyond = [](const boost::math::chi_squared& law, double tail) {
    return boost::math::quantile(boost::math::complement(law, tail));
  };
  const double tail = boost::math::cdf(boost::math::complement(in_range, sample.value));
  if (tail > kLastTail) return value_beyond(full, tail);
  return capped(sample.value * value_beyond(full, kLastTail) / value_beyond(in_range, kLastTail));
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
