// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/control_motion.hpp"

#include <array>
#include <cmath>

namespace montecarta::filters {
namespace {

/// A rule for functions of a control with normal noise; both are exact for polynomials of degree 5.
template <std::size_t N>
struct ControlRule {
  std::array<double, N> nodes;  ///< in standard deviations
  std::array<double, N> weights;
  double sign;  ///< of a variance in the square of a coefficient, and of the covariance
};

constexpr double kRoot3 = 1.7320508075688773, kRoot6 = 2.449489742783178;

/// f averaged over the noise: of the true control by the measured one, where noise follows it.
constexpr ControlRule<3> kAverage{{0.0, kRoot3, -kRoot3}, {2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0}, 1.0};

/// The inverse: what has the average f at the true control, 3 f - 3 D f + D D f with D the average.
constexpr ControlRule<5> kUnbiased{
    {0.0, kRoot3, -kRoot3, kRoot6, -kRoot6}, {5.0 / 3.0, -0.5, -0.5, 1.0 / 6.0, 1.0 / 6.0}, -1.0};

/// Displacement (forward, left, turn) in the frame of the vehicle before the step.
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

/// A part of the displacement: a coefficient of known mean and variance times a column that depends
/// on the bend alone.
template <std::size_t N>
struct Part {
  double mean, variance;
  std::array<Column3<double>, N> at_node;

  Column3<double> average(const ControlRule<N>& rule) const {
    Column3<double> sum{0.0, 0.0, 0.0};
    for (std::size_t k = 0; k < N; ++k) sum = sum + rule.weights[k] * at_node[k];
    return sum;
  }
};

/// Moments of the sum of parts whose coefficients are independent: E d d' - E d E d', or d d' less
/// the unbiased estimate of that of the true control.
template <std::size_t N, std::size_t Parts>
BodyMoments moments_of(const std::array<Part<N>, Parts>& parts, const ControlRule<N>& rule) {
  BodyMoments result{{0.0, 0.0, 0.0}, {}};
  for (std::size_t i = 0; i < Parts; ++i) {
    const auto& [mean, variance, columns] = parts[i];
    const Column3<double> average = parts[i].average(rule);
    Symmetric3<double> second;  // about the origin, of a coefficient 1
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

/// The displacement of a vehicle of type V, part by part: one for each control that it is linear
/// in, at 1 per unit, and the turn by the bend itself, less that of the central node. `bends` are
/// those of the nodes.
template <class V, std::size_t N>
BodyMoments body_moments(const V& vehicle, const std::array<Bend<double>, N>& bends,
                         const Control& control, double duration, const ControlOf<double>& sigma,
                         const ControlRule<N>& rule) {
  constexpr std::size_t kLinear = kLinearOf<V>;
  std::array<Part<N>, kLinear + (V::kTurnsByBend ? 1 : 0)> parts;
  for (std::size_t i = 0; i < kLinear; ++i) {
    parts[i] = {.mean = control[i], .variance = sigma[i] * sigma[i], .at_node = {}};
    for (std::size_t k = 0; k < bends.size(); ++k) {
      const auto [forward, left, turn] = unit_travel(vehicle, i, 1.0, bends[k], duration);
      parts[i].at_node[k] = {forward, left, turn};
    }
  }
  if constexpr (V::kTurnsByBend) {
    parts.back() = {.mean = 1.0, .variance = 0.0, .at_node = {}};
    for (std::size_t k = 0; k < bends.size(); ++k) {
      parts.back().at_node[k] = {0.0, 0.0, bends[k].angle - bends[0].angle};
    }
  }
  BodyMoments moments = moments_of(parts, rule);
  if constexpr (V::kTurnsByBend) moments.mean.h += bends[0].angle;
  return moments;
}

/// P, but pivots of its Cholesky factor that are negative taken for zero.
Symmetric3<double> nearest_covariance(const Symmetric3<double>& P) {
  const Cholesky3<double> L(P);
  return {.xx = L.xx * L.xx,
          .xy = L.yx * L.xx,
          .yy = L.yx * L.yx + L.yy * L.yy,
          .xh = L.hx * L.xx,
          .yh = L.hx * L.yx + L.hy * L.yy,
          .hh = L.hx * L.hx + L.hy * L.hy + L.hh * L.hh};
}

/// The motion of a vehicle of type V.
template <class V, std::size_t N>
MotionIncrement moved_by_rule(const V& vehicle, const MotionIncrement& before,
                              const Control& control, double duration,
                              const ControlOf<double>& sigma, const ControlRule<N>& rule) {
  constexpr std::size_t kLast = kLinearOf<V>;
  const Pose& from = before.pose();
  std::array<double, N + 1> angles;
  for (std::size_t k = 0; k < N; ++k) {
    angles[k] = (control[kLast] + rule.nodes[k] * sigma[kLast]) * vehicle.bend_scale(duration);
  }
  angles[N] = from.heading;
  const auto directions = directions_of<N + 1>(angles);
  std::array<Bend<double>, N> bends;
  for (std::size_t k = 0; k < N; ++k) bends[k] = {angles[k], directions[k]};
  const Direction<double>& course = directions.back();
  const auto [way, moments] = body_moments(vehicle, bends, control, duration, sigma, rule);
  const auto noise = rule.sign < 0.0 ? nearest_covariance(moments) : moments;
  const Point moved = in_world(course, way.x, way.y);
  return {{from.x + moved.x, from.y + moved.y, wrap(from.heading + way.h)},
          sheared(before.covariance(), -moved.y, moved.x) + turned(noise, course)};
}

template <std::size_t N>
MotionIncrement moved_by_rule(const MotionIncrement& before, const Control& control,
                              double duration, const Belief& belief, const ControlRule<N>& rule) {
  const auto sigma = deviations_of(belief.control, control, belief.vehicle);
  return std::visit(
      [&](const auto& one) { return moved_by_rule(one, before, control, duration, sigma, rule); },
      belief.vehicle);
}

}  // namespace

MotionIncrement moved_by_quadrature(const MotionIncrement& before, const Control& control,
                                    double duration, const Belief& belief) {
  return moved_by_rule(before, control, duration, belief, kAverage);
}

MotionIncrement moved_by_unbiased_controls(const MotionIncrement& before, const Control& control,
                                           double duration, const Belief& belief) {
  return moved_by_rule(before, control, duration, belief, kUnbiased);
}

}  // namespace montecarta::filters
