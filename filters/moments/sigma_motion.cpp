// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/sigma_motion.hpp"

#include <cmath>

namespace montecarta {
namespace {

/// Half the difference of two points' images, and how far their middle lies from the centre's.
struct Pair {
  Eigen::Vector3d odd, even;
};

/// A step along `course` with the front wheel at `wheel`, as the pairs need it.
struct Step {
  double way;        ///< speed times duration [m]
  double wheelbase;  ///< [m]
  Direction<double> course, wheel;
};

/// Points that differ in heading, by the angle of `turn`, and in place: `column` is the spread
/// column of the square root.
Pair heading_pair(const Step& step, const Eigen::Vector3d& column) {
  const Direction<double> turn = direction_of(column(2));
  const auto& [c, s] = step.course;
  return {column + step.way * turn.sine * Eigen::Vector3d(-s, c, 0.0),
          step.way * (turn.cosine - 1.0) * Eigen::Vector3d(c, s, 0.0)};
}

/// Points that differ in steer by `angle` [rad].
Pair steer_pair(const Step& step, double angle) {
  const Direction<double> turn = direction_of(angle);
  const auto& [c, s] = step.course;
  const double L = step.wheelbase;
  return {step.way * turn.sine * Eigen::Vector3d(-s, c, step.wheel.cosine / L),
          step.way * (turn.cosine - 1.0) * Eigen::Vector3d(c, s, step.wheel.sine / L)};
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
  const Step step{control.speed * duration, belief.wheelbase,
                  direction_of(from.heading + control.steer), direction_of(control.steer)};
  const Eigen::Vector3d column = heading_column(before.covariance());
  const Pair heading = heading_pair(step, rule.spread * column);
  const Pair steer = steer_pair(step, rule.spread * belief.sigma_steer);
  const Eigen::Vector3d speed =  // the way is linear in it: no points needed
      belief.sigma_speed * duration *
      Eigen::Vector3d(step.course.cosine, step.course.sine, step.wheel.sine / step.wheelbase);

  const Eigen::Vector3d e = rule.mean_weight * (heading.even + steer.even);
  const Pose centre = move(from, control, duration, belief.wheelbase);
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
