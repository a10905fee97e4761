// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/motion_increment.hpp"

#include <cmath>

namespace montecarta::filters {
namespace {

/// Half the difference of two points' images, and how far their middle lies from the centre's.
struct Pair {
  Column3<double> odd, even;
};

/// A step as the vehicle sees it, in the world: its displacement and its turn.
Column3<double> turned(const Column3<double>& step, const Direction<double>& course) {
  const Point way = in_world(course, step.x, step.y);
  return {way.x, way.y, step.h};
}

/// Points that differ in heading, by `turn`, and in place: `column` is the spread column of the
/// square root.
Pair heading_pair(const Column3<double>& step, const Column3<double>& column,
                  const Direction<double>& turn) {
  const double bend = turn.cosine - 1.0;
  return {{column.x - turn.sine * step.y, column.y + turn.sine * step.x, column.h},
          {bend * step.x, bend * step.y, 0.0}};
}

/// Points that differ in steering angle; their images are combined before they are turned.
Pair steer_pair(const Column3<double>& centre, const Column3<double>& leftward,
                const Column3<double>& rightward, const Direction<double>& course) {
  return {turned(0.5 * (leftward - rightward), course),
          turned(0.5 * (leftward + rightward) - centre, course)};
}

/// The column of the square root that carries the heading; zero where the heading is certain.
Column3<double> heading_column(const Symmetric3<double>& P) {
  if (P.hh <= 1e-18) return {0.0, 0.0, 0.0};  // certain but for rounding
  const double root = std::sqrt(P.hh), inverse = 1.0 / root;
  return {P.xh * inverse, P.yh * inverse, root};
}

/// The direction at the sum of two angles.
Direction<double> at_sum(const Direction<double>& a, const Direction<double>& b) {
  return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
}

}  // namespace

MotionIncrement moved_by_sigma_points(const MotionIncrement& before, const Control& control,
                                      double duration, const Belief& belief,
                                      const SigmaRule& rule) {
  const Pose& from = before.pose();
  const Column3<double> column = heading_column(before.covariance());
  const auto [course, turn, ahead, aside] = directions_of<4>(
      {from.heading, rule.spread * column.h, control.steer, rule.spread * belief.sigma_steer});
  const auto image = [&](double speed, const Direction<double>& wheel) {
    const auto step = body_step(belief.vehicle, speed, wheel, duration);
    return Column3<double>{step.forward, step.left, step.turn};
  };
  const Column3<double> centre = image(control.speed, ahead);
  const Column3<double> step = turned(centre, course);
  Symmetric3<double> P = before.covariance();
  add_outer(P, -1.0, column);
  add_outer(P, 1.0, turned(image(belief.sigma_speed, ahead), course));  // linear: no points
  const auto add = [&](const Pair& pair) {
    add_outer(P, rule.antisymmetric, pair.odd);
    add_outer(P, rule.symmetric, pair.even);
    return pair.even;
  };
  const Column3<double> a = add(heading_pair(step, rule.spread * column, turn));
  const Column3<double> b =
      add(steer_pair(centre, image(control.speed, at_sum(ahead, aside)),
                     image(control.speed, at_sum(ahead, {aside.cosine, -aside.sine})), course));
  const Column3<double> e = rule.mean_weight * (a + b);
  add_outer(P, rule.shift, e);
  return {{from.x + step.x + e.x, from.y + step.y + e.y, wrap(from.heading + step.h + e.h)}, P};
}

}  // namespace montecarta::filters
