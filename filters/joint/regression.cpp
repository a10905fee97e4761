// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"
#include "filters/moments/sigma_rule.hpp"

#include <Eigen/Cholesky>

#include <cmath>

// A JointGaussian by regression on sigma points instead of derivatives (EQUATIONS (15.13),
// (15.14)).

namespace montecarta::filters {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Matrix35 = Eigen::Matrix<double, 3, 5>;

/// What observations and motions depend on nonlinearly has three dimensions at most.
SigmaRule rule() { return unscented_rule(3.0, 1.0, 0.0, 0.0); }

/// [m^2, rad^2] added to variances, so that what is known exactly has a slope.
constexpr double kSmallest = 1e-14;

/// By (x, y, heading, landmark's x, y): landmark less place, along and across the line of sight,
/// and heading. With these axes a turned world gives the turned estimate.
Matrix35 line_of_sight(const Eigen::Vector2d& away) {
  const double range = away.norm();
  Eigen::Vector2d ray = Eigen::Vector2d::UnitX();
  if (range > 0.0) ray = away / range;
  Eigen::Matrix2d axes;
  axes << ray.transpose(), (quarter_turn() * ray).transpose();
  Matrix35 T = Matrix35::Zero();
  T.topLeftCorner<2, 2>() = -axes;
  T.topRightCorner<2, 2>() = axes;
  T(2, 2) = 1.0;
  return T;
}

/// Pairs of sigma points, less the centre: half their difference, and their mean.
struct Differences {
  Matrix23 odd, even;
};

/// Covariance of the mean's shift and of what is not linear.
Eigen::Matrix2d curvature(const Matrix23& even, const Eigen::Vector2d& shift) {
  return rule().symmetric * even * even.transpose() + rule().shift * shift * shift.transpose();
}

/// `observe` of the centre moved by the columns of `root`; nullopt where a landmark is too near.
template <class Observe>
std::optional<Differences> differences(const Observe& observe, const Eigen::Vector2d& centre,
                                       const Matrix3& root, const Wraps& wraps) {
  Differences found;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto ahead = observe(rule().spread * root.col(k));
    const auto back = observe(-rule().spread * root.col(k));
    if (!ahead || !back) return std::nullopt;
    const Eigen::Vector2d more = models::residual(ahead->value, centre, wraps);
    const Eigen::Vector2d less = models::residual(back->value, centre, wraps);
    found.odd.col(k) = 0.5 * (more - less);
    found.even.col(k) = 0.5 * (more + less);
  }
  return found;
}

}  // namespace

JointGaussian::Trouble JointGaussian::look_by_sigma_points(const PointMoments& landmark,
                                                           ExpectedObservation& expected) const {
  const Eigen::Vector2d away = landmark.mean - place_of(pose_.mean);
  const Matrix35 T = line_of_sight(away);
  Eigen::Matrix<double, 5, 5> P;
  P << pose_.covariance, landmark.cross.transpose(), landmark.cross, landmark.covariance;
  const Eigen::LLT<Matrix3> factor(T * P * T.transpose() + kSmallest * Matrix3::Identity());
  if (factor.info() != Eigen::Success) return Trouble::faulty;
  const Matrix3 root = factor.matrixL();
  const auto observe = [&](const Eigen::Vector3d& step) {
    const Eigen::Vector2d to = away + T.topRightCorner<2, 2>().transpose() * step.head<2>();
    return linearised_detection(belief_.sensor, Pose{0.0, 0.0, pose_.mean.heading + step(2)},
                                Point{to.x(), to.y()});
  };
  const auto centre = observe(Eigen::Vector3d::Zero());
  if (!centre) return Trouble::too_near;
  const auto found = differences(observe, centre->value, root, wraps_);
  if (!found) return Trouble::too_near;
  const Eigen::Vector2d shift = rule().mean_weight * found->even.rowwise().sum();
  const Eigen::Matrix<double, 3, 2> slope =
      factor.matrixU().solve(found->odd.transpose()) / rule().spread;
  const Eigen::Matrix<double, 2, 5> H = slope.transpose() * T;
  expected = {.pose_jacobian = H.leftCols<3>(),
              .landmark_jacobian = H.rightCols<2>(),
              .observation = centre->value + shift,
              .factor = {},
              .ahead = Eigen::Vector2d::Zero(),
              .wraps = wraps_};
  return weigh(landmark, curvature(found->even, shift), expected);
}

LinearisedMotion JointGaussian::regressed(const MotionIncrement& motion) const {
  LinearisedMotion moved = linearised(motion);
  const double turn = rule().spread * std::sqrt(pose_.covariance(2, 2));
  if (!(turn > 0.0)) return moved;
  const Eigen::Vector2d way(moved.mean.x - pose_.mean.x, moved.mean.y - pose_.mean.y);
  const Eigen::Vector2d even = (std::cos(turn) - 1.0) * way, shift = rule().mean_weight * even;
  moved.mean.x += shift(0);
  moved.mean.y += shift(1);
  moved.by_heading *= std::sin(turn) / turn;
  moved.noise.topLeftCorner<2, 2>() +=
      rule().symmetric * even * even.transpose() + rule().shift * shift * shift.transpose();
  return moved;
}

}  // namespace montecarta::filters
