// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/motion_increment.hpp"

#include <array>
#include <cmath>

namespace montecarta::filters {
namespace {

/// Of a standard normal: exact for polynomials of degree 5.
constexpr std::array<double, 3> kNodes{0.0, 1.7320508075688773, -1.7320508075688773};
constexpr std::array<double, 3> kWeights{2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0};

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
struct Part {
  double mean, variance;
  std::array<Column3<double>, kNodes.size()> at_node;

  Column3<double> average() const {
    Column3<double> sum{0.0, 0.0, 0.0};
    for (std::size_t k = 0; k < at_node.size(); ++k) sum = sum + kWeights[k] * at_node[k];
    return sum;
  }
};

/// Moments of the sum of parts whose coefficients are independent.
template <std::size_t N>
BodyMoments moments_of(const std::array<Part, N>& parts) {
  BodyMoments result{{0.0, 0.0, 0.0}, {}};
  for (std::size_t i = 0; i < N; ++i) {
    const auto& [mean, variance, columns] = parts[i];
    const Column3<double> average = parts[i].average();
    Symmetric3<double> second;  // about the origin, of a coefficient 1
    for (std::size_t k = 0; k < kNodes.size(); ++k) add_outer(second, kWeights[k], columns[k]);
    const double square = mean * mean;
    Symmetric3<double> covariance = (square + variance) * second;
    add_outer(covariance, -square, average);
    for (std::size_t j = 0; j < i; ++j) {
      const double product = mean * parts[j].mean;
      for (std::size_t k = 0; k < kNodes.size(); ++k) {
        add_cross(covariance, product * kWeights[k], columns[k], parts[j].at_node[k]);
      }
      add_cross(covariance, -product, average, parts[j].average());
    }
    result.mean = result.mean + mean * average;
    result.covariance = result.covariance + covariance;
  }
  return result;
}

/// The displacement of a vehicle of type V, part by part: one for each control that it is linear
/// in, at 1 per unit, and the turn by the bend itself, less that of the central node. `bends` are
/// those of the nodes.
template <class V>
BodyMoments body_moments(const V& vehicle, const std::array<Bend<double>, kNodes.size()>& bends,
                         const Control& control, double duration, const ControlOf<double>& sigma) {
  constexpr std::size_t kLinear = kLinearOf<V>;
  std::array<Part, kLinear + (V::kTurnsByBend ? 1 : 0)> parts;
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
  BodyMoments moments = moments_of(parts);
  if constexpr (V::kTurnsByBend) moments.mean.h += bends[0].angle;
  return moments;
}

/// The motion of a vehicle of type V.
template <class V>
MotionIncrement averaged(const V& vehicle, const MotionIncrement& before, const Control& control,
                         double duration, const ControlOf<double>& sigma) {
  constexpr std::size_t kLast = kLinearOf<V>;
  const Pose& from = before.pose();
  const auto angle = [&](std::size_t k) {
    return (control[kLast] + kNodes[k] * sigma[kLast]) * vehicle.bend_scale(duration);
  };
  const auto directions = directions_of<4>({angle(0), angle(1), angle(2), from.heading});
  std::array<Bend<double>, kNodes.size()> bends;
  for (std::size_t k = 0; k < kNodes.size(); ++k) bends[k] = {angle(k), directions[k]};
  const Direction<double>& course = directions.back();
  const auto [way, noise] = body_moments(vehicle, bends, control, duration, sigma);
  const Point moved = in_world(course, way.x, way.y);
  return {{from.x + moved.x, from.y + moved.y, wrap(from.heading + way.h)},
          sheared(before.covariance(), -moved.y, moved.x) + turned(noise, course)};
}

}  // namespace

MotionIncrement moved_by_quadrature(const MotionIncrement& before, const Control& control,
                                    double duration, const Belief& belief) {
  const auto sigma = deviations_of(belief.control, control, belief.vehicle);
  return std::visit(
      [&](const auto& one) { return averaged(one, before, control, duration, sigma); },
      belief.vehicle);
}

}  // namespace montecarta::filters
