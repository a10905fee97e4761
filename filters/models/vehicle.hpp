// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/car.hpp"
#include "filters/models/differential_drive.hpp"
#include "filters/models/increment_noise.hpp"
#include "filters/models/omnidirectional.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <tuple>
#include <variant>

namespace montecarta::models {

/// All vehicles; the first is the default. To add one, write a struct like these in a file of its
/// own and list it here. The members of a vehicle with n controls are
/// - kNames, name(), named(): its names in study files; kControls: its n controls; numbers(): its
///   other settings; `integration`: only if the user may choose it;
/// - travel(): its displacement at a given TurningAngle, linear in the first n - 1 controls. The
///   angle is the last control times angle_scale(). If kTurnsByAngle, the vehicle turns by that
///   angle and the turn of travel() is 0;
/// - travel_by_angle(): the derivative of travel(); control_of(): the control of a step;
/// - steered(), way_to_turn(), kTurnLimit: how a pilot turns it to a way-point.
using Vehicle = std::variant<Car, DifferentialDrive, Omnidirectional>;

/// The number of controls of a vehicle of type V, and the number of those in which it is linear.
template <class V>
inline constexpr std::size_t kControlsOf = std::tuple_size_v<decltype(V::kControls)>;
template <class V>
inline constexpr std::size_t kLinearOf = kControlsOf<V> - 1;

/// The controls of a vehicle, in order.
inline std::span<const Quantity> controls_of(const Vehicle& vehicle) {
  return std::visit([](const auto& one) { return std::span<const Quantity>(one.kControls); },
                    vehicle);
}

/// The number of leading controls that are all 0 if the vehicle stands still. A steering angle
/// alone moves nothing.
inline std::size_t moving_controls(std::span<const Quantity> controls) {
  std::size_t moving = 0;
  while (moving < controls.size() && controls[moving] != Quantity::steer) ++moving;
  return moving;
}

/// A control that may differ between the lanes (Real).
template <class Real>
using ControlOf = std::array<Real, Control::kMost>;

/// Returns the first N components of a control.
template <std::size_t N, class Real>
std::array<Real, N> first_of(const ControlOf<Real>& control) {
  std::array<Real, N> first;
  for (std::size_t i = 0; i < N; ++i) first[i] = control[i];
  return first;
}

/// The angle [rad] in which a step of `duration` [s] is not linear (see TurningAngle).
template <class V>
double bend_angle(const V& vehicle, const Control& control, double duration) {
  return control[kLinearOf<V>] * vehicle.angle_scale(duration);
}

/// One control step of `duration` [s] in the frame of the vehicle (EQUATIONS 1), for one vehicle
/// (double) or one per lane; `turning_angle` belongs to the control.
template <class V, class Real>
BodyStep<Real> body_step_at(const V& vehicle, const ControlOf<Real>& control,
                            const TurningAngle<Real>& turning_angle, double duration) {
  BodyStep<Real> step = vehicle.travel(first_of<kLinearOf<V>>(control), turning_angle, duration);
  if constexpr (V::kTurnsByAngle) step.turn = turning_angle.angle;
  return step;
}
/// Does the same with the turning angle that follows from the control.
template <class V, class Real>
BodyStep<Real> body_step_of(const V& vehicle, const ControlOf<Real>& control, double duration) {
  const Real angle = control[kLinearOf<V>] * Real(vehicle.angle_scale(duration));
  return body_step_at(vehicle, control, turning_angle_of(angle), duration);
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

/// Returns the share of component i in a step: travel() with that component equal to `size` and all
/// others 0.
template <class V>
BodyStep<double> unit_travel(const V& vehicle, std::size_t i, double size,
                             const TurningAngle<double>& turning_angle, double duration) {
  std::array<double, kLinearOf<V>> linear{};
  linear[i] = size;
  return vehicle.travel(linear, turning_angle, duration);
}

/// body_step_at() with its derivatives; `turning_angle` belongs to the control.
template <class V>
[[gnu::always_inline]] inline DifferentiatedStep<kControlsOf<V>> differentiated_step(
    const V& vehicle, const Control& control, const TurningAngle<double>& turning_angle,
    double duration) {
  constexpr std::size_t kLinear = kLinearOf<V>;
  DifferentiatedStep<kControlsOf<V>> result{
      .step = body_step_at(vehicle, control.values, turning_angle, duration), .by_control = {}};
  for (std::size_t i = 0; i < kLinear; ++i) {
    result.by_control[i] = unit_travel(vehicle, i, 1.0, turning_angle, duration);
  }
  BodyStep<double>& last = result.by_control[kLinear];
  last = vehicle.travel_by_angle(first_of<kLinear>(control.values), turning_angle, duration);
  if constexpr (V::kTurnsByAngle) {
    const double scale = vehicle.angle_scale(duration);
    last = {last.forward * scale, last.left * scale, scale};
  }
  return result;
}

/// The control that turns a simulated vehicle to a way-point.
inline Control steered(const Vehicle& vehicle, const PilotInput& input) {
  return std::visit([&](const auto& one) { return one.steered(input); }, vehicle);
}

/// Longest distance [m] driven at `speed` [m/s] until steered() has reached any given heading.
inline double way_to_turn(const Vehicle& vehicle, double speed) {
  return std::visit([&](const auto& one) { return one.way_to_turn(speed); }, vehicle);
}
/// The setting that limits how fast the vehicle turns.
inline const char* turn_limit_key(const Vehicle& vehicle) {
  return std::visit([](const auto& one) { return one.kTurnLimit; }, vehicle);
}

/// Returns whether the motion model is not defined for this control, which may occur in a log.
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

/// The control that moves a vehicle by `step` in `duration` [s], the inverse of body_step(). If the
/// vehicle cannot move like that, it is the nearest possible control.
inline Control control_of(const BodyStep<double>& step, double duration, const Vehicle& vehicle) {
  return std::visit([&](const auto& one) { return one.control_of(step, duration); }, vehicle);
}

/// Independent noise of the controls of a vehicle, with constant deviations `sigma` and a part that
/// grows with the control by `alpha` (EQUATIONS (1.10); Thrun 2005, table 5.3).
struct ControlNoise {
  std::array<double, Control::kMost> sigma{};  ///< deviation of each component, in its unit
  /// Factors of the squares of the speeds (all components but the last) and of the last component
  /// (steering angle or yaw rate): two in the variances of the speeds, two in that of the last.
  std::array<double, 4> alpha{};
  IncrementNoise increment = {};  ///< noise of the step that the controls cause

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
