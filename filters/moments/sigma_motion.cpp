// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/sigma_motion.hpp"

#include <cmath>

namespace montecarta {
namespace {

/// Half the difference of two points' images, and how far their middle lies from the centre's.
struct Pair {
  Eigen::Vector3d odd, even;
};

/// A step as the vehicle sees it, in the world: its displacement and its turn.
Eigen::Vector3d turned(const BodyStep<double>& step, const Direction<double>& heading) {
  const Point way = in_world(heading, step.forward, step.left);
  return {way.x, way.y, step.turn};
}

/// Points that differ in heading, by the angle of `turn`, and in place: `column` is the spread
/// column of the square root.
Pair heading_pair(const Eigen::Vector3d& step, const Eigen::Vector3d& column) {
  const Direction<double> turn = direction_of(column(2));
  return {column + turn.sine * Eigen::Vector3d(-step(1), step(0), 0.0),
          (turn.cosine - 1.0) * Eigen::Vector3d(step(0), step(1), 0.0)};
}

/// The column of the square root that carries the heading; zero where the heading is certain.
Eigen::Vector3d heading_column(const Eigen::Matrix3d& P) {
  if (P(2, 2) <= 1e-18) return Eigen::Vector3d::Zero();  // SPEC 4
  return P.col(2) / std::sqrt(P(2, 2));
}

}  // namespace

MotionIncrement moved_by_sigma_points(const MotionIncrement& before, const Control& control,
                                      double duration, const Belief& belief,
                                      const SigmaRule& rule) {
  const Pose& from = before.pose();
  const Direction<double> course = direction_of(from.heading);
  const auto image = [&](double speed, double steer) {
    return turned(body_step(belief.vehicle, speed, steer, duration), course);
  };
  const Eigen::Vector3d step = image(control.speed, control.steer);
  const Eigen::Vector3d column = heading_column(before.covariance());
  const Pair heading = heading_pair(step, rule.spread * column);
  const double angle = rule.spread * belief.sigma_steer;
  const Eigen::Vector3d leftward = image(control.speed, control.steer + angle);
  const Eigen::Vector3d rightward = image(control.speed, control.steer - angle);
  const Pair steer{0.5 * (leftward - rightward), 0.5 * (leftward + rightward) - step};
  const Eigen::Vector3d speed = image(belief.sigma_speed, control.steer);  // linear: no points

  const Eigen::Vector3d e = rule.mean_weight * (heading.even + steer.even);
  const Pose centre = move(from, control, duration, belief.vehicle);
  Eigen::Matrix3d P = before.covariance() - column * column.transpose();
  P += speed * speed.transpose();
  P += rule.antisymmetric *
       (heading.odd * heading.odd.transpose() + steer.odd * steer.odd.transpose());
  P += rule.symmetric *
       (heading.even * heading.even.transpose() + steer.even * steer.even.transpose());
  P += rule.shift * e * e.transpose();
  return {{centre.x + e(0), centre.y + e(1), wrap(centre.heading + e(2))}, P};
}

}  // namespace montecarta
