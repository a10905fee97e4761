// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/body_step.hpp"

#include <array>
#include <cmath>

namespace montecarta::models {

/// The model of the noise of a step, besides that of its controls (EQUATIONS 1).
enum class IncrementModel {
  none,
  additive,  ///< independent noise of the displacement forward, to the left, and of the turn
  odometry   ///< noise of a rotation, a translation and a rotation (Thrun 2005, table 5.6)
};

/// Noise of the step of a vehicle in its own frame.
struct IncrementNoise {
  IncrementModel model = IncrementModel::none;
  /// Deviations after one second, forward, left [m/s^0.5] and of the turn [rad/s^0.5] (additive).
  std::array<double, 3> sigma{};
  std::array<double, 4> alpha{};  ///< alpha_1 to alpha_4 of EQUATIONS (1.12) (odometry)

  bool is_none() const { return model == IncrementModel::none; }
};

/// A step as a rotation [rad], a translation [m] and another rotation [rad] (EQUATIONS (1.12)). A
/// vehicle that drives backwards is translated backwards instead of being rotated by pi.
template <class Real>
struct TurnedWay {
  Real rot1, trans, rot2;
};

template <class Real>
TurnedWay<Real> turned_way_of(const BodyStep<Real>& step) {
  const Real sign = select(step.forward < Real(0.0), Real(-1.0), Real(1.0));
  const Real trans = length(step.forward, step.left);
  const Real ahead = select(trans > Real(0.0), Real(sign * step.forward), Real(1.0));
  const Real rot1 = atan2(Real(sign * step.left), ahead);
  return {rot1, sign * trans, step.turn - rot1};
}

template <class Real>
BodyStep<Real> step_of(const TurnedWay<Real>& turned) {
  const Direction<Real> course = direction_of(turned.rot1);
  return {turned.trans * course.cosine, turned.trans * course.sine, turned.rot1 + turned.rot2};
}

/// Standard deviations of the three independent noises of `step`, which lasts `duration` [s].
inline std::array<double, 3> increment_deviations(const IncrementNoise& noise,
                                                  const BodyStep<double>& step, double duration) {
  if (noise.model == IncrementModel::additive) {
    const double root = std::sqrt(duration);
    return {noise.sigma[0] * root, noise.sigma[1] * root, noise.sigma[2] * root};
  }
  const auto [rot1, trans, rot2] = turned_way_of(step);
  const double first = rot1 * rot1, way = trans * trans, second = rot2 * rot2;
  return {std::sqrt(noise.alpha[0] * first + noise.alpha[1] * way),
          std::sqrt(noise.alpha[2] * way + noise.alpha[3] * (first + second)),
          std::sqrt(noise.alpha[0] * second + noise.alpha[1] * way)};
}

/// The derivatives of `step` by its three noises, each times its deviation: columns of a square
/// root of the covariance that the noise adds, in the frame of the vehicle before the step.
inline std::array<BodyStep<double>, 3> increment_columns(const IncrementNoise& noise,
                                                         const BodyStep<double>& step,
                                                         double duration) {
  const auto [first, second, third] = increment_deviations(noise, step, duration);
  if (noise.model == IncrementModel::additive)
    return {{{first, 0.0, 0.0}, {0.0, second, 0.0}, {0.0, 0.0, third}}};
  const Direction<double> course = direction_of(turned_way_of(step).rot1);
  return {{{-first * step.left, first * step.forward, first},
           {second * course.cosine, second * course.sine, 0.0},
           {0.0, 0.0, third}}};
}

/// `step` with its noises, which are `deviations` times the standard normals `e`.
template <class Real>
BodyStep<Real> perturbed(const BodyStep<Real>& step, IncrementModel model,
                         const std::array<double, 3>& deviations, const std::array<Real, 3>& e) {
  const std::array<Real, 3> by{deviations[0] * e[0], deviations[1] * e[1], deviations[2] * e[2]};
  if (model == IncrementModel::additive)
    return {step.forward + by[0], step.left + by[1], step.turn + by[2]};
  const auto [rot1, trans, rot2] = turned_way_of(step);
  return step_of(TurnedWay<Real>{rot1 + by[0], trans + by[1], rot2 + by[2]});
}

}  // namespace montecarta::models
