// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/retraction.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::filters {
namespace {

// The order is that of the enumerators.
const std::vector<std::string> kMoments{"map", "pushed"};

/// The nonnegative nodes of Gauss-Hermite quadrature with nine nodes for a standard normal
/// variable. Each weight is the sum of those of both signs.
constexpr std::array<std::pair<double, double>, 5> kTurnNodes{
    {{0.0, 0.40634920634920635},
     {1.0232556637891326, 0.4881950057898787},
     {2.07684797867783, 0.0998328135304243},
     {3.2054290028564703, 0.005578282642463529},
     {4.512745863399783, 4.469168801549348e-05}}};

/// Averages over a rotation by a ~ N(0, variance); exponential_jacobian(a) is along I + across J.
struct TurnAverages {
  double cosine;           ///< E cos a; E (a sin a) is this times the variance
  double cosine_variance;  ///< variance of cos a
  double sine_variance;    ///< variance of sin a
  double along_squared = 0.0;
  double across_squared = 0.0;

  explicit TurnAverages(double variance)
      : cosine(std::exp(-0.5 * variance)),
        cosine_variance(0.5 * std::expm1(-variance) * std::expm1(-variance)),
        sine_variance(-0.5 * std::expm1(-2.0 * variance)) {
    for (const auto& [node, weight] : kTurnNodes) {
      const Eigen::Matrix2d V = exponential_jacobian(node * std::sqrt(variance));
      along_squared += weight * V(0, 0) * V(0, 0);
      across_squared += weight * V(1, 0) * V(1, 0);
    }
  }

  /// Covariance of two points; k and l are their regressions on the rotation.
  Eigen::Matrix2d covariance(const Eigen::Matrix2d& P, const Eigen::Vector2d& k,
                             const Eigen::Vector2d& l, double variance) const {
    const Eigen::Matrix2d J = quarter_turn();
    const Eigen::Matrix2d rest = P - variance * k * l.transpose();
    const Eigen::Vector2d Jk = J * k, Jl = J * l;
    return along_squared * rest + across_squared * (J * rest * J.transpose()) +
           cosine_variance * Jk * Jl.transpose() + sine_variance * k * l.transpose();
  }
};

/// First row of point i: the vehicle, then the landmarks.
Eigen::Index row_of_point(Eigen::Index i) { return i == 0 ? 0 : 1 + 2 * i; }

}  // namespace

Parameter moments_option(const char* fallback) {
  return choice_parameter(
      "moments", fallback, kMoments,
      "reported mean and covariance: those of the Gaussian in map coordinates (map), or those that "
      "follow from it in the right-invariant chart (pushed) (EQUATIONS 19, 21)");
}

Moments moments_of(const FilterOptions& options) {
  return chosen<Moments>(options.choice("moments"), kMoments);
}

void push_moments(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) {
  const double variance = covariance(2, 2);
  if (!(variance > 0.0)) return;
  const TurnAverages averages(variance);
  const Eigen::Index points = (mean.size() - 1) / 2;
  const auto regression = [&](Eigen::Index row) -> Eigen::Vector2d {
    return covariance.block<2, 1>(row, 2) / variance;
  };
  for (Eigen::Index i = 0; i < points; ++i) {
    const Eigen::Index row = row_of_point(i);
    const Eigen::Vector2d k = regression(row);
    mean.segment<2>(row) += (1.0 - averages.cosine) * (quarter_turn() * k);
    for (Eigen::Index j = 0; j <= i; ++j) {
      const Eigen::Index column = row_of_point(j);
      Eigen::Matrix2d P =
          averages.covariance(covariance.block<2, 2>(row, column), k, regression(column), variance);
      if (i == j) P(0, 1) = P(1, 0);
      covariance.block<2, 2>(row, column) = P;
      covariance.block<2, 2>(column, row) = P.transpose();
    }
  }
  for (Eigen::Index i = 0; i < points; ++i) {
    const Eigen::Index row = row_of_point(i);
    covariance.block<2, 1>(row, 2) *= averages.cosine;
    covariance.block<1, 2>(2, row) = covariance.block<2, 1>(row, 2).transpose();
  }
}

PoseMoments pushed(const PoseMoments& pose) {
  Eigen::Vector3d mean(pose.mean.x, pose.mean.y, pose.mean.heading);
  PoseMoments result = pose;
  push_moments(mean, result.covariance);
  result.mean = {mean.x(), mean.y(), pose.mean.heading};
  return result;
}

LandmarkEstimate pushed(const PointMoments& point, double heading_variance) {
  Eigen::Vector3d mean(point.mean.x(), point.mean.y(), 0.0);
  Eigen::Matrix3d P;
  P << point.covariance, point.cross.col(2), point.cross.col(2).transpose(), heading_variance;
  push_moments(mean, P);
  return {mean.head<2>(), P.topLeftCorner<2, 2>()};
}

}  // namespace montecarta::filters
