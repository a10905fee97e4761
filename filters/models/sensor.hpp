// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/numbers/real.hpp"
#include "filters/models/sensor_kinds.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace montecarta::models {

/// Where a sensor sits on the vehicle and where it looks (EQUATIONS 2).
struct Mounting {
  double forward = 0.0;  ///< [m] of the pose
  double left = 0.0;     ///< [m]
  double turn = 0.0;     ///< [rad] counter-clockwise from the heading

  bool is_none() const { return forward == 0.0 && left == 0.0 && turn == 0.0; }
  /// [m] from the pose.
  double distance() const { return length(forward, left); }

  /// Of the sensor, on a vehicle at `pose`.
  Pose pose_of(const Pose& pose) const;
  /// Derivative of pose_of() by the pose.
  Eigen::Matrix3d jacobian(const Pose& pose) const;

 private:
  Eigen::Vector2d arm_of(const Pose& pose) const;
};

/// All sensors there are; the first is the default. One more is a struct like these and its name
/// here. It says
/// - kName: what study files call it; kComponents: one or two quantities that it measures;
/// - detection_of(): what it sees of a landmark at a range and bearing of the sensor;
/// - linearised(): that for a pose of the sensor, with derivatives; nullopt where there are none;
/// - placed(): where one detection places a landmark; only where it does.
using SensorKind = std::variant<RangeBearingSensor, BearingSensor, RangeSensor, PositionSensor>;

/// A sensor on its vehicle.
struct Sensor {
  SensorKind kind = {};
  Mounting mounting = {};
};

/// The components of its detections, in their order.
std::span<const Quantity> components_of(const Sensor& sensor);
std::string name_of(const Sensor& sensor);

/// Calls `visit` with one sensor of each kind, in the order of the list.
template <class Visit>
void for_each_sensor(const Visit& visit) {
  const auto each = [&]<std::size_t... I>(std::index_sequence<I...>) {
    (visit(Sensor{std::variant_alternative_t<I, SensorKind>{}, {}}), ...);
  };
  each(std::make_index_sequence<std::variant_size_v<SensorKind>>());
}
/// Names of all sensors, the default first.
std::vector<std::string> sensor_names();
/// Names of those that measure this.
std::vector<std::string> sensors_with(Quantity quantity);
/// The sensor of that name; nullopt where there is none.
std::optional<Sensor> sensor_named(std::string_view name, const Mounting& mounting = {});

/// Whether one detection fixes a landmark: it then is a Gaussian.
template <class Kind>
concept FixesLandmark = requires {
  Kind::placed(Pose(), Eigen::Vector2d());
};
bool fixes_landmark(const Sensor& sensor);

/// What it sees of a landmark at that range and bearing of the sensor.
Eigen::Vector2d detection_of(const Sensor& sensor, const RangeBearing<double>& from);

/// What it should see of a landmark from a vehicle at `pose`, with derivatives by that pose;
/// nullopt where the landmark is too near for them.
std::optional<LinearisedDetection> linearised_detection(const Sensor& sensor, const Pose& pose,
                                                        const Point& landmark);

/// Where one detection from a vehicle at `pose` places a landmark, with derivatives by that pose;
/// nullopt where it does not fix one.
std::optional<PlacedLandmark> placed_landmark(const Sensor& sensor, const Pose& pose,
                                              const Eigen::Vector2d& detection);

/// The measured part of a detection.
inline Eigen::Vector2d vector_of(const Detection& detection) {
  return {detection[0], detection[1]};
}

/// Which components are angles.
using Wraps = std::array<bool, Detection::kMost>;
Wraps wraps_of(const Sensor& sensor);
/// detected less predicted, angles by the shorter way.
inline Eigen::Vector2d residual(const Eigen::Vector2d& detected, const Eigen::Vector2d& predicted,
                                const Wraps& wraps) {
  Eigen::Vector2d difference = detected - predicted;
  if (wraps[0]) difference(0) = wrap(difference(0));
  if (wraps[1]) difference(1) = wrap(difference(1));
  return difference;
}

/// [m] from the sensor to what it detected; nullopt where detections of these components do not
/// say.
std::optional<double> distance_in(std::span<const Quantity> components, const Detection& detection);

/// Standard deviations that `owner` (a belief, a scenario) has of the components. A component that
/// the sensor does not have has derivatives of 0 and, here, a deviation of 1: it changes nothing.
template <class Owner>
Eigen::Vector2d deviations_of(const Sensor& sensor, const Owner& owner) {
  Eigen::Vector2d sigma = Eigen::Vector2d::Ones();
  Eigen::Index i = 0;
  for (const Quantity quantity : components_of(sensor)) sigma(i++) = deviation_of(quantity, owner);
  return sigma;
}

/// [m] that noise shifts a landmark by at that distance [m]; of range and bearing along the range.
template <class Owner>
double length_deviation(const Sensor& sensor, const Owner& owner, double distance) {
  const auto components = components_of(sensor);
  const double first = deviation_of(components[0], owner);
  if (components[0] == Quantity::bearing) return first * distance;
  if (components[0] == Quantity::range) return first;
  return std::max(first, deviation_of(components[1], owner));
}

}  // namespace montecarta::models
