// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/error_anatomy.hpp"

#include "analysis/statistics/means.hpp"
#include "engine/random/stream.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

constexpr double kFewestRunsOfMoments = 4.0;
constexpr std::size_t kDraws = 2000;

/// One scan's moments over runs.
struct Moment {
  Eigen::Vector3d bias;
  Eigen::Matrix3d squares;     ///< mean squared error
  Eigen::Matrix3d covariance;  ///< believed
  double n;
};

double bias_share(const Moment& m) {
  const Eigen::LLT<Eigen::Matrix3d> P(m.covariance);
  const double nees = P.solve(m.squares).trace();
  const double by_bias = m.bias.dot(P.solve(m.bias));
  const double by_chance = (nees - by_bias) / (m.n - 1.0);  // of a mean over n errors without bias
  return std::clamp((by_bias - by_chance) / nees, 0.0, 1.0);
}

struct Worst {
  double ratio;
  Eigen::Vector3d shares;
};

Worst worst_of(const Moment& m) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix3d> solver(m.squares, m.covariance);
  const Eigen::Vector3d weights =
      solver.eigenvectors().col(2).cwiseProduct(m.covariance.diagonal().cwiseSqrt());
  return {solver.eigenvalues()(2), weights.cwiseAbs2() / weights.squaredNorm()};
}

/// Adds up what is averaged over scans.
class OverScans {
 public:
  void add(double share, const Worst& worst) {
    share_ += share;
    logarithm_ += std::log(worst.ratio);
    direction_ += worst.shares;
    n_ += 1.0;
  }
  void put(ErrorAnatomy& anatomy) const {
    anatomy.mean_bias_share = share_ / n_;
    anatomy.mean_worst_ratio = std::exp(logarithm_ / n_);
    for (int c = 0; c < 3; ++c)
      anatomy.worst_direction[static_cast<std::size_t>(c)] = direction_(c) / n_;
  }

 private:
  double share_ = 0.0, logarithm_ = 0.0, n_ = 0.0;
  Eigen::Vector3d direction_ = Eigen::Vector3d::Zero();
};

}  // namespace

// Bartlett's decomposition: n times the mean squared error of whitened errors is T T', T lower
// triangular of normals below roots of chi-squares.
double expected_worst_ratio(std::size_t runs, double level) {
  if (runs < 3) return std::numeric_limits<double>::infinity();
  const auto n = static_cast<double>(runs);
  std::vector<double> ratios;
  for (std::size_t k = 0; k < kDraws; ++k) {
    RngStream draw(
        {.seed = 1, .run = k, .step = 0, .index = 0, .purpose = Draw::analysis_bootstrap});
    Eigen::Matrix3d T = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      T(i, i) = std::sqrt(boost::math::quantile(boost::math::chi_squared(n - i), draw.uniform()));
      for (int j = 0; j < i; ++j) T(i, j) = draw.normal();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(T * T.transpose() / n,
                                                                Eigen::EigenvaluesOnly);
    ratios.push_back(solver.eigenvalues()(2));
  }
  const auto nth = ratios.begin() + static_cast<std::ptrdiff_t>(level * (kDraws - 1));
  std::ranges::nth_element(ratios, nth);
  return *nth;
}

void ErrorMoments::add(std::span<const Eigen::Vector3d> errors,
                       std::span<const Eigen::Matrix3d> covariances) {
  for (std::size_t s = 0; s < scans_.size(); ++s) {
    if (!errors[s].allFinite() || !covariances[s].allFinite()) continue;
    scans_[s].n += 1.0;
    scans_[s].error += errors[s];
    scans_[s].squares += errors[s] * errors[s].transpose();
    scans_[s].covariance += covariances[s];
  }
}

ErrorAnatomy ErrorMoments::result() const {
  ErrorAnatomy anatomy;
  OverScans over_scans;
  for (const Sums& sums : scans_) {
    const Moment m{sums.error / sums.n, sums.squares / sums.n, sums.covariance / sums.n, sums.n};
    for (int c = 0; c < 3; ++c) {
      const auto component = static_cast<std::size_t>(c);
      anatomy.happened[component].push_back(std::sqrt(m.squares(c, c)));
      anatomy.believed[component].push_back(std::sqrt(m.covariance(c, c)));
      anatomy.bias[component].push_back(m.bias(c));
    }
    const bool known = m.n >= kFewestRunsOfMoments &&
                       Eigen::LLT<Eigen::Matrix3d>(m.covariance).info() == Eigen::Success;
    const Worst worst = known ? worst_of(m) : Worst{kNaN, {}};
    anatomy.bias_share.push_back(known ? bias_share(m) : kNaN);
    anatomy.worst_ratio.push_back(worst.ratio);
    if (known && worst.ratio > 0.0) over_scans.add(anatomy.bias_share.back(), worst);
  }
  over_scans.put(anatomy);
  return anatomy;
}

}  // namespace montecarta::analysis
