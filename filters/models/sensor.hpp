// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/// Pose of a sensor in the frame of the vehicle (EQUATIONS 2).
struct Mounting {
  double forward = 0.0;  ///< [m] from the vehicle's reference point
  double left = 0.0;     ///< [m] from the vehicle's reference point
  double turn = 0.0;     ///< [rad] counter-clockwise from the heading

  bool is_none() const { return forward == 0.0 && left == 0.0 && turn == 0.0; }
  /// Distance [m] of the sensor from the vehicle's reference point.
  double distance() const { return length(forward, left); }

  /// Pose of the sensor on a vehicle at `pose`.
  Pose pose_of(const Pose& pose) const;
  /// Derivative of pose_of() by the pose.
  Eigen::Matrix3d jacobian(const Pose& pose) const;

 private:
  Eigen::Vector2d arm_of(const Pose& pose) const;
};

/// All sensors; the first is the default. To add one, write a struct like these and list it here.
/// Its members are
/// - kName: its name in study files; kComponents: the one or two quantities that it measures;
/// - detection_of(): its detection of a landmark at a given range and bearing from the sensor;
/// - linearised(): the same for a pose of the sensor, with derivatives; nullopt if there are none;
/// - placed(): the landmark that one detection fixes; absent if one detection fixes none.
using SensorKind = std::variant<RangeBearingSensor, BearingSensor, RangeSensor, PositionSensor>;

/// A sensor and its mounting on the vehicle.
struct Sensor {
  SensorKind kind = {};
  Mounting mounting = {};
};

/// Returns the components of the detections of a sensor, in order.
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
/// Names of the sensors that measure this quantity.
std::vector<std::string> sensors_with(Quantity quantity);
/// The sensor of that name; nullopt if there is none.
std::optional<Sensor> sensor_named(std::string_view name, const Mounting& mounting = {});

/// True for sensors of which one detection fixes a landmark, with a Gaussian as its estimate.
template <class Kind>
concept FixesLandmark = requires {
  Kind::placed(Pose(), Eigen::Vector2d());
};
bool fixes_landmark(const Sensor& sensor);

/// The detection, without noise, of a landmark at this range and bearing from the sensor.
Eigen::Vector2d detection_of(const Sensor& sensor, const RangeBearing<double>& from);

/// The predicted detection of a landmark from a vehicle at `pose`, with derivatives by that pose;
/// nullopt if the landmark is too near for them.
std::optional<LinearisedDetection> linearised_detection(const Sensor& sensor, const Pose& pose,
                                                        const Point& landmark);

/// The landmark that one detection from a vehicle at `pose` fixes, with derivatives by that pose;
/// nullopt if one detection fixes none.
std::optional<PlacedLandmark> placed_landmark(const Sensor& sensor, const Pose& pose,
                                              const Eigen::Vector2d& detection);

/// The measured values of a detection.
inline Eigen::Vector2d vector_of(const Detection& detection) {
  return {detection[0], detection[1]};
}

/// Flags of the components that are angles.
using Wraps = std::array<bool, Detection::kMost>;
Wraps wraps_of(const Sensor& sensor);
/// Innovation, detected minus predicted, with angles wrapped.
inline Eigen::Vector2d residual(const Eigen::Vector2d& detected, const Eigen::Vector2d& predicted,
                                const Wraps& wraps) {
  Eigen::Vector2d difference = detected - predicted;
  if (wraps[0]) difference(0) = wrap(difference(0));
  if (wraps[1]) difference(1) = wrap(difference(1));
  return difference;
}

/// Distance [m] from the sensor to the detected landmark; nullopt if these components do not
/// determine it.
std::optional<double> distance_in(std::span<const Quantity> components, const Detection& detection);

/// Standard deviations of the components in `owner` (a belief or a scenario). A component that the
/// sensor does not have gets the deviation 1; its derivatives are 0, so that it changes nothing.
template <class Owner>
Eigen::Vector2d deviations_of(const Sensor& sensor, const Owner& owner) {
  Eigen::Vector2d sigma = Eigen::Vector2d::Ones();
  Eigen::Index i = 0;
  for (const Quantity quantity : components_of(sensor)) sigma(i++) = deviation_of(quantity, owner);
  return sigma;
}

/// Standard deviation [m] by which noise shifts a landmark at `distance` [m], along the range.
template <class Owner>
double length_deviation(const Sensor& sensor, const Owner& owner, double distance) {
  const auto components = components_of(sensor);
  const double first = deviation_of(components[0], owner);
  if (components[0] == Quantity::bearing) return first * distance;
  if (components[0] == Quantity::range) return first;
  return std::max(first, deviation_of(components[1], owner));
}

}  // namespace montecarta::models
