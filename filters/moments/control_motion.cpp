// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/control_motion.hpp"

#include "filters/models/ackermann.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

/// Images of two opposite points: half their difference, and their mean minus the centre's image.
struct PointPair {
  Column3<double> odd, even;
};

/// A step in the frame of the vehicle, rotated into the world.
Column3<double> turned(const Column3<double>& step, const Direction<double>& course) {
  const Point way = in_world(course, step.x, step.y);
  return {way.x, way.y, step.h};
}

/// The pair of points that differ in heading by `turn` and in position; `column` is the column of
/// the square root times the spread.
PointPair heading_pair(const Column3<double>& step, const Column3<double>& column,
                       const Direction<double>& turn) {
  const double turning_angle = turn.cosine - 1.0;
  return {{column.x - turn.sine * step.y, column.y + turn.sine * step.x, column.h},
          {turning_angle * step.x, turning_angle * step.y, 0.0}};
}

/// Points that differ in the turning angle; their images are combined before they are rotated.
PointPair bend_pair(const Column3<double>& centre, const Column3<double>& leftward,
                    const Column3<double>& rightward, const Direction<double>& course) {
  return {turned(0.5 * (leftward - rightward), course),
          turned(0.5 * (leftward + rightward) - centre, course)};
}

/// The column of the square root that has the heading; zero if the heading is certain.
Column3<double> heading_column(const Symmetric3<double>& P) {
  if (P.hh <= 1e-18) return {0.0, 0.0, 0.0};  // certain up to rounding
  const double root = std::sqrt(P.hh), inverse = 1.0 / root;
  return {P.xh * inverse, P.yh * inverse, root};
}

/// Returns the sum of two turning angles.
TurningAngle<double> at_sum(const TurningAngle<double>& a, const TurningAngle<double>& b) {
  const auto& [c, s] = a.direction;
  const auto& [d, t] = b.direction;
  return {a.angle + b.angle, {c * d - s * t, s * d + c * t}};
}

Column3<double> column_of(const BodyStep<double>& step) {
  return {step.forward, step.left, step.turn};
}

/// The motion of a vehicle of type V. It is flattened, since calls out of line pass their arguments
/// through memory.
template <class V>
[[gnu::flatten]] MotionIncrement moved(const V& vehicle, const MotionIncrement& before,
                                       const Control& control, double duration,
                                       const ControlOf<double>& sigma, const SigmaRule& rule) {
  constexpr std::size_t kLinear = kLinearOf<V>;
  const Pose& from = before.pose();
  const Column3<double> column = heading_column(before.covariance());
  const double scale = vehicle.angle_scale(duration);
  const double angle = control[kLinear] * scale, spread = rule.spread * (sigma[kLinear] * scale);
  const auto [course, turn, ahead, aside] =
      directions_of<4>({from.heading, rule.spread * column.h, angle, spread});
  const TurningAngle<double> turning_angle{angle, ahead};
  const auto image = [&](const TurningAngle<double>& at) {
    return column_of(body_step_at(vehicle, control.values, at, duration));
  };
  const Column3<double> centre = image(turning_angle);
  const Column3<double> step = turned(centre, course);
  Symmetric3<double> P = before.covariance();
  add_outer(P, -1.0, column);
  const auto add_linear = [&, course = course](std::size_t i) {  // linear, so no points are needed
    const auto travel = unit_travel(vehicle, i, sigma[i], turning_angle, duration);
    add_outer(P, 1.0, turned(column_of(travel), course));
  };
  add_linear(0);  // not a loop: g++ 12 fuses the products of in_world() if it vectorises one
  if constexpr (kLinear > 1) add_linear(1);
  const auto add = [&](const PointPair& pair) {
    add_outer(P, rule.antisymmetric, pair.odd);
    add_outer(P, rule.symmetric, pair.even);
    return pair.even;
  };
  const Column3<double> a = add(heading_pair(step, rule.spread * column, turn));
  const Column3<double> b =
      add(bend_pair(centre, image(at_sum(turning_angle, {spread, aside})),
                    image(at_sum(turning_angle, {-spread, {aside.cosine, -aside.sine}})), course));
  const Column3<double> e = rule.mean_weight * (a + b);
  add_outer(P, rule.shift, e);
  return {{from.x + step.x + e.x, from.y + step.y + e.y, wrap(from.heading + step.h + e.h)}, P};
}

/// A quadrature rule for functions of a control with normal noise, exact up to degree 5.
template <std::size_t N>
struct ControlRule {
  std::array<double, N> nodes;  ///< nodes in standard deviations
  std::array<double, N> weights;
  double sign;  ///< sign of the variance of a coefficient, and of the covariance (moments_of())
};

constexpr double kRoot3 = 1.7320508075688773, kRoot6 = 2.449489742783178;

/// Averages a function f over noise that is added to the control.
constexpr ControlRule<3> kAverage{{0.0, kRoot3, -kRoot3}, {2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0}, 1.0};

/// The inverse average: 3 f - 3 D f + D D f, with D the average, averages to f at the true control.
constexpr ControlRule<5> kUnbiased{
    {0.0, kRoot3, -kRoot3, kRoot6, -kRoot6}, {5.0 / 3.0, -0.5, -0.5, 1.0 / 6.0, 1.0 / 6.0}, -1.0};

/// Moments of a displacement (forward, left, turn) in the frame of the vehicle before the step.
struct BodyMoments {
  Column3<double> mean;
  Symmetric3<double> covariance;
};

/// Adds weight (a b' + b a').
void add_cross(Symmetric3<double>& P, double weight, const Column3<double>& a,
               const Column3<double>& b) {
  add_outer(P, 0.5 * weight, a + b);
  add_outer(P, -0.5 * weight, a - b);
}

/// A summand of the displacement: a coefficient of known mean and variance times a column that
/// depends only on the turning angle.
template <std::size_t N>
struct BodyPart {
  double mean, variance;
  std::array<Column3<double>, N> at_node;

  Column3<double> average(const ControlRule<N>& rule) const {
    Column3<double> sum{0.0, 0.0, 0.0};
    for (std::size_t k = 0; k < N; ++k) sum = sum + rule.weights[k] * at_node[k];
    return sum;
  }
};

/// Moments of the sum of parts with independent coefficients. The covariance is E d d' minus E d E
/// d' for kAverage; for kUnbiased, d d' minus its unbiased estimate at the true control.
template <std::size_t N, std::size_t Parts>
BodyMoments moments_of(const std::array<BodyPart<N>, Parts>& parts, const ControlRule<N>& rule) {
  BodyMoments result{{0.0, 0.0, 0.0}, {}};
  for (std::size_t i = 0; i < Parts; ++i) {
    const auto& [mean, variance, columns] = parts[i];
    const Column3<double> average = parts[i].average(rule);
    Symmetric3<double> second;  // second moment about the origin, for the coefficient 1
    for (std::size_t k = 0; k < N; ++k) add_outer(second, rule.weights[k], columns[k]);
    const double square = mean * mean;
    Symmetric3<double> covariance = (square + rule.sign * variance) * second;
    add_outer(covariance, -square, average);
    for (std::size_t j = 0; j < i; ++j) {
      const double product = mean * parts[j].mean;
      for (std::size_t k = 0; k < N; ++k) {
        add_cross(covariance, product * rule.weights[k], columns[k], parts[j].at_node[k]);
      }
      add_cross(covariance, -product, average, parts[j].average(rule));
    }
    result.mean = result.mean + mean * average;
    result.covariance = result.covariance + rule.sign * covariance;
  }
  return result;
}

/// Moments of the displacement of a vehicle of type V. It has one part for each control in which it
/// is linear, per unit of that control, and one for the turning angle itself, relative to that
/// of the central node. `turning_angles` are those of the nodes.
template <class V, std::size_t N>
BodyMoments body_moments(const V& vehicle,
                         const std::array<TurningAngle<double>, N>& turning_angles,
                         const Control& control, double duration, const ControlOf<double>& sigma,
                         const ControlRule<N>& rule) {
  constexpr std::size_t kLinear = kLinearOf<V>;
  std::array<BodyPart<N>, kLinear + (V::kTurnsByAngle ? 1 : 0)> parts;
  for (std::size_t i = 0; i < kLinear; ++i) {
    parts[i] = {.mean = control[i], .variance = sigma[i] * sigma[i], .at_node = {}};
    for (std::size_t k = 0; k < turning_angles.size(); ++k) {
      parts[i].at_node[k] = column_of(unit_travel(vehicle, i, 1.0, turning_angles[k], duration));
    }
  }
  if constexpr (V::kTurnsByAngle) {
    parts.back() = {.mean = 1.0, .variance = 0.0, .at_node = {}};
    for (std::size_t k = 0; k < turning_angles.size(); ++k) {
      parts.back().at_node[k] = {0.0, 0.0, turning_angles[k].angle - turning_angles[0].angle};
    }
  }
  BodyMoments moments = moments_of(parts, rule);
  if constexpr (V::kTurnsByAngle) moments.mean.h += turning_angles[0].angle;
  return moments;
}

/// P, with negative pivots of its Cholesky factor replaced by zero.
Symmetric3<double> nearest_covariance(const Symmetric3<double>& P) {
  const Cholesky3<double> L(P);
  return {.xx = L.xx * L.xx,
          .xy = L.yx * L.xx,
          .yy = L.yx * L.yx + L.yy * L.yy,
          .xh = L.hx * L.xx,
          .yh = L.hx * L.yx + L.hy * L.yy,
          .hh = L.hx * L.hx + L.hy * L.hy + L.hh * L.hh};
}

template <class V, std::size_t N>
MotionIncrement moved_by_rule(const V& vehicle, const MotionIncrement& before,
                              const Control& control, double duration,
                              const ControlOf<double>& sigma, const ControlRule<N>& rule) {
  constexpr std::size_t kLast = kLinearOf<V>;
  const Pose& from = before.pose();
  std::array<double, N + 1> angles;
  for (std::size_t k = 0; k < N; ++k) {
    angles[k] = (control[kLast] + rule.nodes[k] * sigma[kLast]) * vehicle.angle_scale(duration);
  }
  angles[N] = from.heading;
  const auto directions = directions_of<N + 1>(angles);
  std::array<TurningAngle<double>, N> turning_angles;
  for (std::size_t k = 0; k < N; ++k) turning_angles[k] = {angles[k], directions[k]};
  const Direction<double>& course = directions.back();
  const auto [way, moments] = body_moments(vehicle, turning_angles, control, duration, sigma, rule);
  const auto noise = rule.sign < 0.0 ? nearest_covariance(moments) : moments;
  const Point moved = in_world(course, way.x, way.y);
  return {{from.x + moved.x, from.y + moved.y, wrap(from.heading + way.h)},
          sheared(before.covariance(), -moved.y, moved.x) + turned(noise, course)};
}

/// `after`, with the noise of the step from `before` besides that of its controls.
MotionIncrement with_increment_noise(MotionIncrement after, const MotionIncrement& before,
                                     const Control& control, double duration,
                                     const Belief& belief) {
  if (belief.control.increment.is_none()) return after;
  after.add_increment_noise(direction_of(before.pose().heading), control, duration, belief);
  return after;
}

template <std::size_t N>
MotionIncrement moved_by_rule(const MotionIncrement& before, const Control& control,
                              double duration, const Belief& belief, const ControlRule<N>& rule) {
  const auto sigma = deviations_of(belief.control, control, belief.vehicle);
  const MotionIncrement after = std::visit(
      [&](const auto& one) { return moved_by_rule(one, before, control, duration, sigma, rule); },
      belief.vehicle);
  return with_increment_noise(after, before, control, duration, belief);
}

// The order is that of the enumerators.
const std::vector<std::string> kMotions{"linearised", "quadrature", "unbiased"};

Parameter motion_option(const char* fallback) {
  return choice_parameter("motion", fallback, kMotions,
                          "how the noise of the control is propagated to the pose: by derivatives "
                          "(linearised), by averaging over it (quadrature), or as the noise of a "
                          "measurement of the true control (unbiased)");
}

}  // namespace

MotionIncrement moved_by_sigma_points(const MotionIncrement& before, const Control& control,
                                      double duration, const Belief& belief,
                                      const SigmaRule& rule) {
  const auto sigma = deviations_of(belief.control, control, belief.vehicle);
  const MotionIncrement after = std::visit(
      [&](const auto& one) { return moved(one, before, control, duration, sigma, rule); },
      belief.vehicle);
  return with_increment_noise(after, before, control, duration, belief);
}

MotionIncrement moved_by_quadrature(const MotionIncrement& before, const Control& control,
                                    double duration, const Belief& belief) {
  return moved_by_rule(before, control, duration, belief, kAverage);
}

MotionIncrement moved_by_unbiased_controls(const MotionIncrement& before, const Control& control,
                                           double duration, const Belief& belief) {
  return moved_by_rule(before, control, duration, belief, kUnbiased);
}

Parameter linearised_motion_option() { return motion_option("linearised"); }

Parameter fitting_motion_option() {
  Parameter option = motion_option("quadrature");
  option.fallback_if_measured = "unbiased";
  return option;
}

Motion motion_of(const FilterOptions& options) {
  return chosen<Motion>(options.choice("motion"), kMotions);
}

void advance(MotionIncrement& increment, const Control& control, double duration,
             const Belief& belief, Motion motion) {
  if (motion == Motion::linearised) return increment.advance(control, duration, belief);
  increment = motion == Motion::quadrature
                  ? moved_by_quadrature(increment, control, duration, belief)
                  : moved_by_unbiased_controls(increment, control, duration, belief);
}

}  // namespace montecarta::filters
