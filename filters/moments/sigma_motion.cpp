// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/sigma_motion.hpp"

#include "engine/numbers/directions.hpp"

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

/// Points that differ in heading, by `turn`, and in place: `column` is the spread column of the
/// square root.
Pair heading_pair(const Eigen::Vector3d& step, const Eigen::Vector3d& column,
                  const Direction<double>& turn) {
  return {column + turn.sine * Eigen::Vector3d(-step(1), step(0), 0.0),
          (turn.cosine - 1.0) * Eigen::Vector3d(step(0), step(1), 0.0)};
}

/// The column of the square root that carries the heading; zero where the heading is certain.
Eigen::Vector3d heading_column(const Symmetric3<double>& P) {
  if (P.hh <= 1e-18) return Eigen::Vector3d::Zero();  // SPEC 4
  const double root = std::sqrt(P.hh), inverse = 1.0 / root;
  return {P.xh * inverse, P.yh * inverse, root};
}

}  // namespace

MotionIncrement moved_by_sigma_points(const MotionIncrement& before, const Control& control,
                                      double duration, const Belief& belief,
                                      const SigmaRule& rule) {
  const Pose& from = before.pose();
  const Eigen::Vector3d column = heading_column(before.covariance());
  const double angle = rule.spread * belief.sigma_steer;
  const auto [course, turn, ahead, left, right] =
      directions_of<5>({from.heading, rule.spread * column(2), control.steer, control.steer + angle,
                        control.steer - angle});
  const auto image = [&](double speed, const Direction<double>& wheel) {
    return turned(body_step(belief.vehicle, speed, wheel, duration), course);
  };
  const Eigen::Vector3d step = image(control.speed, ahead);
  const Pair heading = heading_pair(step, rule.spread * column, turn);
  const Eigen::Vector3d leftward = image(control.speed, left);
  const Eigen::Vector3d rightward = image(control.speed, right);
  const Pair steer{0.5 * (leftward - rightward), 0.5 * (leftward + rightward) - step};
  const Eigen::Vector3d speed = image(belief.sigma_speed, ahead);  // linear: no points

  const Eigen::Vector3d e = rule.mean_weight * (heading.even + steer.even);
  Symmetric3<double> P = before.covariance();
  add_outer(P, -1.0, column);
  add_outer(P, 1.0, speed);
  for (const Pair& pair : {heading, steer}) {
    add_outer(P, rule.antisymmetric, pair.odd);
    add_outer(P, rule.symmetric, pair.even);
  }
  add_outer(P, rule.shift, e);
  return {{from.x + step(0) + e(0), from.y + step(1) + e(1), wrap(from.heading + step(2) + e(2))},
          P};
}

}  // namespace montecarta
