// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/nees.hpp"

#include "analysis/run/whitened_run.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/symmetric_eigen.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

std::string name_of(ErrorBlock block) {
  return std::array{"pose", "position", "heading"}.at(static_cast<std::size_t>(block));
}

std::string name_of(Moments moments) {
  return std::array{"corrected", "mixture", "spread"}.at(static_cast<std::size_t>(moments));
}

bool is_drawn(const MomentRows& spread, const MomentRows& mixture, std::size_t row) {
  if (mixture.covariance.empty()) return true;
  const auto first = static_cast<std::ptrdiff_t>(9 * row);
  const auto begin = spread.covariance.begin() + first;
  return !std::equal(begin, begin + 9, mixture.covariance.begin() + first);
}

EffectiveDraws draws_at(const RunRows& rows, std::size_t particles, std::size_t s) {
  return effective_draws(particles,
                         rows.ess.empty() ? static_cast<double>(particles) : rows.ess[s]);
}

namespace {

constexpr double kLeastPivot = 1e-12;  // least pivot, and least eigenvalue that counts in the rank
constexpr double kMostNegative = -1e-9;  // least eigenvalue that rounding explains
// [standard deviations] largest error outside the range of P that second-order effects explain.
constexpr double kFarthestOutside = 10.0;
// [standard deviations] largest asymmetry that rounding to six digits explains.
constexpr double kLargestAsymmetry = 1e-6;
constexpr double kLeastTail = 1e-6;  // tail in which a consistent filter hardly ever lies
const Eigen::Vector3d kLeastDeviation{1e-9, 1e-9, 1e-10};

template <int D>
using Vec = Eigen::Matrix<double, D, 1>;
template <int D>
using Mat = Eigen::Matrix<double, D, D>;

double capped(double nees) { return nees <= kLargestNees ? nees : kLargestNees; }

/// An error in units of its covariance P.
template <int D>
struct Whitened {
  Vec<D> error;      ///< L^-1 e with P = L L'
  Vec<D> deviation;  ///< {component} standard deviation
  double determinant;
};

/// Whitens by Cholesky of the correlation matrix, so that the pivots are independent of units;
/// nullopt if P is singular.
template <int D>
std::optional<Whitened<D>> whitened(const Vec<D>& error, const Mat<D>& covariance,
                                    const Vec<D>& least_variance) {
  std::optional<Whitened<D>> found;
  if (!(covariance.diagonal().array() > least_variance.array()).all()) return found;
  found.emplace();
  found->error.resize(error.size());
  found->deviation = covariance.diagonal().cwiseSqrt();
  const Vec<D> scale = found->deviation.cwiseInverse();
  Vec<D>& y = found->error;
  Mat<D> L(error.size(), error.size());
  for (int i = 0; i < error.size(); ++i) {
    double rest = error(i) * scale(i);
    double pivot = 1.0;
    for (int j = 0; j < i; ++j) {
      double element = covariance(i, j) * scale(i) * scale(j);
      for (int k = 0; k < j; ++k) element -= L(i, k) * L(j, k);
      L(i, j) = j == 0 ? element : element / L(j, j);  // L(0, 0) is 1
      pivot -= L(i, j) * L(i, j);
      rest -= L(i, j) * y(j);
    }
    if (!(pivot > kLeastPivot)) {
      found.reset();
      return found;
    }
    L(i, i) = i == 0 ? 1.0 : std::sqrt(pivot);
    y(i) = i == 0 ? rest : rest / L(i, i);
  }
  found->determinant = covariance.diagonal().prod() * L.diagonal().cwiseAbs2().prod();
  return found;
}

/// The NEES e' P^-1 e, (2.1) of STATISTICS; nullopt if P is singular.
template <int D>
std::optional<double> quadratic_form(const Vec<D>& error, const Mat<D>& covariance,
                                     const Vec<D>& least_variance) {
  const auto found = whitened<D>(error, covariance, least_variance);
  if (!found) return std::nullopt;
  double sum = 0.0;
  for (const double y : found->error) sum += y * y;
  return sum;
}

/// The whitened error; nullopt if P is singular or a number is not finite. There is no branch for
/// each number.
std::optional<Whitened<3>> whitened_pose(const Eigen::Vector3d& error,
                                         const Eigen::Matrix3d& covariance) {
  const bool is_finite = (error - error).sum() + (covariance - covariance).sum() == 0.0;
  if (!is_finite) return std::nullopt;
  return whitened<3>(error, covariance, kLeastDeviation.cwiseAbs2());
}

constexpr Nees kUnusableSample = {kNaN, Nees::kUnusable};

/// Indices of the components with a variance above the least one; nullopt if a variance is
/// negative, or if a covariance is larger than its two variances allow.
std::optional<std::vector<Eigen::Index>> open_components(const Eigen::MatrixXd& P,
                                                         const Eigen::VectorXd& least_variance) {
  std::vector<Eigen::Index> found;
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    if (P(i, i) > least_variance(i)) {
      found.push_back(i);
      continue;
    }
    if (P(i, i) < -least_variance(i)) return std::nullopt;
    for (Eigen::Index j = 0; j < P.rows(); ++j) {
      const double most = std::max(P(j, j), least_variance(j)) * least_variance(i);
      const double covariance = P(std::max(i, j), std::min(i, j));
      if (i != j && covariance * covariance > most) return std::nullopt;
    }
  }
  return found;
}

/// NEES in the range of a singular P, for the components that are not known exactly. An error that
/// is farther outside the range than second-order effects explain has the largest NEES.
Nees nees_in_range(const Eigen::VectorXd& error, const Eigen::MatrixXd& P,
                   const Eigen::VectorXd& least_variance) {
  const auto components = open_components(P, least_variance);
  if (!components) return kUnusableSample;
  const std::vector<Eigen::Index>& open = *components;
  if (open.empty()) return {kNaN, 0};
  const Eigen::MatrixXd block = P(open, open);
  const Eigen::VectorXd scale = block.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = scale.asDiagonal() * block * scale.asDiagonal();
  const SymmetricEigen eigen = symmetric_eigen(correlation);
  const Eigen::VectorXd along = eigen.vectors.transpose() * scale.cwiseProduct(error(open));
  Nees sample = {0.0, 0};
  double outside = 0.0;
  for (Eigen::Index k = 0; k < along.size(); ++k) {
    const double eigenvalue = eigen.values(k);
    if (!(eigenvalue >= kMostNegative)) return kUnusableSample;
    if (eigenvalue > kLeastPivot) {
      sample.value += along(k) * along(k) / eigenvalue;
      ++sample.rank;
    } else {
      outside += along(k) * along(k);
    }
  }
  const bool is_far_outside = !(outside <= kFarthestOutside * kFarthestOutside);
  sample.value = is_far_outside ? kLargestNees : capped(sample.value);
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
  const auto found = whitened_pose(error, covariance);
  if (!found) {
    return {nees<3>(error, covariance), nees<2>(error, covariance), nees<1>(error, covariance, 2)};
  }
  const Eigen::Vector3d& y = found->error;
  const double position = y(0) * y(0) + y(1) * y(1);
  const double heading = error(2) * (1.0 / found->deviation(2));
  return {Nees{capped(position + y(2) * y(2)), 3}, Nees{capped(position), 2},
          Nees{capped(heading * heading), 1}};
}

double negative_log_density(const WhitenedPose& pose) {
  const Eigen::Vector3d& y = pose.whitened;
  return 0.5 * (3.0 * std::log(2.0 * std::numbers::pi) + std::log(pose.determinant) +
                capped(y(0) * y(0) + y(1) * y(1) + y(2) * y(2)));
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

void whiten_pose(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                 WhitenedPose& pose) {
  const auto found = whitened_pose(error, covariance);
  pose.determinant = found ? found->determinant : kNaN;
  if (!found || found->error.cwiseAbs().maxCoeff() > kLargestError) {
    pose.rank = whiten(error, covariance, kLeastDeviation, std::span(pose.whitened.data(), 3),
                       std::span(pose.standardised.data(), 3));
    return;
  }
  for (Eigen::Index k = 0; k < 3; ++k) {
    pose.whitened(k) = found->error(k);
    pose.standardised(k) =
        std::clamp(error(k) / found->deviation(k), -kLargestError, kLargestError);
  }
  pose.rank = 3;
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
    if (!(covariance(i, i) > least(i))) continue;
    open.push_back(i);
    standardised[static_cast<std::size_t>(i)] =
        std::clamp(error(i) / std::sqrt(covariance(i, i)), -kLargestError, kLargestError);
  }
  const auto found = whitened<Eigen::Dynamic>(error(open), covariance(open, open), least(open));
  if (!found) return 0;
  const double largest = open.empty() ? 0.0 : found->error.cwiseAbs().maxCoeff();
  const double scale = largest > kLargestError ? kLargestError / largest : 1.0;
  for (std::size_t k = 0; k < open.size(); ++k) {
    whitened_error[static_cast<std::size_t>(open[k])] =
        scale * found->error(static_cast<Eigen::Index>(k));
  }
  return open.size();
}

void add_errors_of_exact(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance,
                         const Eigen::VectorXd& least_deviation, std::span<double> largest,
                         double rounding) {
  if (!error.allFinite() || !covariance.allFinite()) return;
  for (Eigen::Index i = 0; i < error.size(); ++i) {
    const double size = std::abs(error(i)), least_variance = std::pow(least_deviation(i), 2);
    double& found = largest[static_cast<std::size_t>(i)];
    const bool is_exact = std::abs(covariance(i, i)) <= least_variance;
    if (is_exact && size > rounding) found = std::max(found, size);
  }
}

const Eigen::Vector3d& least_pose_deviation() { return kLeastDeviation; }

double on_full_scale(const Nees& sample, std::size_t dimension) {
  if (sample.rank <= 0) return kNaN;
  if (static_cast<std::size_t>(sample.rank) == dimension || sample.value == 0.0) {
    return sample.value;
  }
  const auto in_range = static_cast<double>(sample.rank), full = static_cast<double>(dimension);
  const double tail = chi_squared_tail(sample.value, in_range);
  if (tail > kLeastTail) return chi_squared_beyond(tail, full);
  return capped(sample.value * chi_squared_beyond(kLeastTail, full) /
                chi_squared_beyond(kLeastTail, in_range));
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
