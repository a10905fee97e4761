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

/// Points that differ in the angle of the bend; their images are combined before they are turned.
Pair bend_pair(const Column3<double>& centre, const Column3<double>& leftward,
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

/// The bend at the sum of two angles.
Bend<double> at_sum(const Bend<double>& a, const Bend<double>& b) {
  const auto& [c, s] = a.direction;
  const auto& [d, t] = b.direction;
  return {a.angle + b.angle, {c * d - s * t, s * d + c * t}};
}

Column3<double> column_of(const BodyStep<double>& step) {
  return {step.forward, step.left, step.turn};
}

/// The motion of a vehicle of type V. What it calls is inlined: out of line it passes through
/// memory.
template <class V>
[[gnu::flatten]] MotionIncrement moved(const V& vehicle, const MotionIncrement& before,
                                       const Control& control, double duration,
                                       const ControlOf<double>& sigma, const SigmaRule& rule) {
  constexpr std::size_t kLinear = kLinearOf<V>;
  const Pose& from = before.pose();
  const Column3<double> column = heading_column(before.covariance());
  const double scale = vehicle.bend_scale(duration);
  const double angle = control[kLinear] * scale, spread = rule.spread * (sigma[kLinear] * scale);
  const auto [course, turn, ahead, aside] =
      directions_of<4>({from.heading, rule.spread * column.h, angle, spread});
  const Bend<double> bend{angle, ahead};
  const auto image = [&](const Bend<double>& at) {
    return column_of(body_step_at(vehicle, control.values, at, duration));
  };
  const Column3<double> centre = image(bend);
  const Column3<double> step = turned(centre, course);
  Symmetric3<double> P = before.covariance();
  add_outer(P, -1.0, column);
  const auto add_linear = [&, course = course](std::size_t i) {  // linear: no points
    const auto travel = unit_travel(vehicle, i, sigma[i], bend, duration);
    add_outer(P, 1.0, turned(column_of(travel), course));
  };
  add_linear(0);  // no loop: g++ 12 fuses the products of in_world() where it vectorises one
  if constexpr (kLinear > 1) add_linear(1);
  const auto add = [&](const Pair& pair) {
    add_outer(P, rule.antisymmetric, pair.odd);
    add_outer(P, rule.symmetric, pair.even);
    return pair.even;
  };
  const Column3<double> a = add(heading_pair(step, rule.spread * column, turn));
  const Column3<double> b =
      add(bend_pair(centre, image(at_sum(bend, {spread, aside})),
                    image(at_sum(bend, {-spread, {aside.cosine, -aside.sine}})), course));
  const Column3<double> e = rule.mean_weight * (a + b);
  add_outer(P, rule.shift, e);
  return {{from.x + step.x + e.x, from.y + step.y + e.y, wrap(from.heading + step.h + e.h)}, P};
}

}  // namespace

MotionIncrement moved_by_sigma_points(const MotionIncrement& before, const Control& control,
                                      double duration, const Belief& belief,
                                      const SigmaRule& rule) {
  const auto sigma = deviations_of(belief.control, control, belief.vehicle);
  return std::visit(
      [&](const auto& one) { return moved(one, before, control, duration, sigma, rule); },
      belief.vehicle);
}

}  // namespace montecarta::filters
