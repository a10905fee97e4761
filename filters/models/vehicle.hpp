// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/car.hpp"
#include "filters/models/differential_drive.hpp"
#include "filters/models/omnidirectional.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <tuple>
#include <variant>

namespace montecarta::models {

/// All vehicles there are; the first is the default. One more is a struct like these, in a file of
/// its own, and its name here. A vehicle of n controls says
/// - kNames, name(), named(): what study files call it; kControls: its n controls; numbers(): its
///   other settings; `integration`, where it has a choice of that;
/// - travel(): its step, linear in the first n - 1 controls, at a given bend. The bend is the angle
///   that the last control times bend_scale() makes; where kTurnsByBend the vehicle turns by it,
///   and travel() turns by nothing;
/// - travel_by_bend(): the derivative of travel(); control_of(): the control of a step;
/// - steered(), way_to_turn(), kTurnLimit: how a pilot turns it to a way-point.
using Vehicle = std::variant<Car, DifferentialDrive, Omnidirectional>;

/// How many controls a vehicle of type V has, and how many of them it is linear in.
template <class V>
inline constexpr std::size_t kControlsOf = std::tuple_size_v<decltype(V::kControls)>;
template <class V>
inline constexpr std::size_t kLinearOf = kControlsOf<V> - 1;

/// The controls of a vehicle, in their order.
inline std::span<const Quantity> controls_of(const Vehicle& vehicle) {
  return std::visit([](const auto& one) { return std::span<const Quantity>(one.kControls); },
                    vehicle);
}

/// How many of the first controls are all 0 where the vehicle stands: a steering angle moves
/// nothing by itself.
inline std::size_t moving_controls(std::span<const Quantity> controls) {
  std::size_t moving = 0;
  while (moving < controls.size() && controls[moving] != Quantity::steer) ++moving;
  return moving;
}

/// A control of which each lane (Real) has its own.
template <class Real>
using ControlOf = std::array<Real, Control::kMost>;

/// The first N components.
template <std::size_t N, class Real>
std::array<Real, N> first_of(const ControlOf<Real>& control) {
  std::array<Real, N> first;
  for (std::size_t i = 0; i < N; ++i) first[i] = control[i];
  return first;
}

/// The angle [rad] in which a step of `duration` [s] is not linear (struct Bend).
template <class V>
double bend_angle(const V& vehicle, const Control& control, double duration) {
  return control[kLinearOf<V>] * vehicle.bend_scale(duration);
}

/// One control step of `duration` [s] of one vehicle (double) or one a lane, in the frame of the
/// vehicle; `bend` is that of the control. EQUATIONS 1.
template <class V, class Real>
BodyStep<Real> body_step_at(const V& vehicle, const ControlOf<Real>& control,
                            const Bend<Real>& bend, double duration) {
  BodyStep<Real> step = vehicle.travel(first_of<kLinearOf<V>>(control), bend, duration);
  if constexpr (V::kTurnsByBend) step.turn = bend.angle;
  return step;
}
/// The same at the bend of the control.
template <class V, class Real>
BodyStep<Real> body_step_of(const V& vehicle, const ControlOf<Real>& control, double duration) {
  const Real angle = control[kLinearOf<V>] * Real(vehicle.bend_scale(duration));
  return body_step_at(vehicle, control, bend_of(angle), duration);
}
template <class Real>
BodyStep<Real> body_step(const Vehicle& vehicle, const ControlOf<Real>& control, double duration) {
  return std::visit([&](const auto& one) { return body_step_of(one, control, duration); }, vehicle);
}
inline BodyStep<double> body_step(const Vehicle& vehicle, const Control& control, double duration) {
  return body_step(vehicle, control.values, duration);
}

/// A step and its derivatives by the N controls, each per its unit.
template <std::size_t N>
struct DifferentiatedStep {
  BodyStep<double> step;
  std::array<BodyStep<double>, N> by_control;
};

/// travel() of component i alone, of that size: its image, for the motion is linear in it.
template <class V>
BodyStep<double> unit_travel(const V& vehicle, std::size_t i, double size, const Bend<double>& bend,
                             double duration) {
  std::array<double, kLinearOf<V>> linear{};
  linear[i] = size;
  return vehicle.travel(linear, bend, duration);
}

/// body_step_at() with its derivatives; `bend` is that of the control.
template <class V>
[[gnu::always_inline]] inline DifferentiatedStep<kControlsOf<V>> differentiated_step(
    const V& vehicle, const Control& control, const Bend<double>& bend, double duration) {
  constexpr std::size_t kLinear = kLinearOf<V>;
  DifferentiatedStep<kControlsOf<V>> result{
      .step = body_step_at(vehicle, control.values, bend, duration), .by_control = {}};
  for (std::size_t i = 0; i < kLinear; ++i) {
    result.by_control[i] = unit_travel(vehicle, i, 1.0, bend, duration);
  }
  BodyStep<double>& last = result.by_control[kLinear];
  last = vehicle.travel_by_bend(first_of<kLinear>(control.values), bend, duration);
  if constexpr (V::kTurnsByBend) {
    const double scale = vehicle.bend_scale(duration);
    last = {last.forward * scale, last.left * scale, scale};
  }
  return result;
}

/// The control that turns a simulated vehicle to a way-point.
inline Control steered(const Vehicle& vehicle, const Aim& aim) {
  return std::visit([&](const auto& one) { return one.steered(aim); }, vehicle);
}

/// [m] that it may drive before it heads anywhere (steered()), at `speed` [m/s].
inline double way_to_turn(const Vehicle& vehicle, double speed) {
  return std::visit([&](const auto& one) { return one.way_to_turn(speed); }, vehicle);
}
/// The setting that says how fast it turns.
inline const char* turn_limit_key(const Vehicle& vehicle) {
  return std::visit([](const auto& one) { return one.kTurnLimit; }, vehicle);
}

/// Whether its model has no answer to this control, which a log may hold.
inline bool is_beyond_model(const Vehicle& vehicle, const Control& control) {
  return std::visit(
      [&](const auto& one) {
        if constexpr (requires { one.is_beyond_model(control); }) {
          return one.is_beyond_model(control);
        } else {
          return false;
        }
      },
      vehicle);
}

/// The control that takes a vehicle through `step` in `duration` [s]: body_step() turned round, or
/// what comes nearest where the vehicle cannot move like that.
inline Control control_of(const BodyStep<double>& step, double duration, const Vehicle& vehicle) {
  return std::visit([&](const auto& one) { return one.control_of(step, duration); }, vehicle);
}

/// The noise of the controls of a vehicle: independent, of the deviations `sigma`, and of `alpha`,
/// what they grow by with the control (EQUATIONS 1; Thrun 2005, table 5.3).
struct ControlNoise {
  std::array<double, Control::kMost> sigma{};  ///< of each component, in its unit
  /// Variance of each but the last component (speeds) by the square of those, and by the square of
  /// the last one (steering angle or yaw rate); variance of the last one likewise.
  std::array<double, 4> alpha{};

  bool grows() const {
    return std::ranges::any_of(alpha, [](double value) { return value != 0.0; });
  }
};

/// Standard deviation of each component of `control`, in its unit.
inline std::array<double, Control::kMost> deviations_of(const ControlNoise& noise,
                                                        const Control& control,
                                                        const Vehicle& vehicle) {
  std::array<double, Control::kMost> sigma = noise.sigma;
  if (!noise.grows()) return sigma;
  const std::size_t last = controls_of(vehicle).size() - 1;
  double speeds = 0.0;
  for (std::size_t i = 0; i < last; ++i) speeds += control[i] * control[i];
  const double turning = control[last] * control[last];
  for (std::size_t i = 0; i <= last; ++i) {
    const double* alpha = &noise.alpha[i == last ? 2 : 0];
    sigma[i] = std::sqrt(sigma[i] * sigma[i] + alpha[0] * speeds + alpha[1] * turning);
  }
  return sigma;
}

}  // namespace montecarta::models
