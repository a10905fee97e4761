// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/sensor.hpp"

namespace montecarta::models {

Pose Mounting::pose_of(const Pose& pose) const {
  if (is_none()) return pose;
  const Eigen::Vector2d arm = arm_of(pose);
  return {pose.x + arm.x(), pose.y + arm.y(), wrap(pose.heading + turn)};
}

Eigen::Matrix3d Mounting::jacobian(const Pose& pose) const {
  const Eigen::Vector2d arm = arm_of(pose);
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  M(0, 2) = -arm.y();
  M(1, 2) = arm.x();
  return M;
}

Eigen::Vector2d Mounting::arm_of(const Pose& pose) const {
  const Direction<double> heading = direction_of(pose.heading);
  return {heading.cosine * forward - heading.sine * left,
          heading.sine * forward + heading.cosine * left};
}

std::span<const Quantity> components_of(const Sensor& sensor) {
  return std::visit([](const auto& one) { return std::span<const Quantity>(one.kComponents); },
                    sensor.kind);
}

std::string name_of(const Sensor& sensor) {
  return std::visit([](const auto& one) { return std::string(one.kName); }, sensor.kind);
}

std::vector<std::string> sensor_names() {
  std::vector<std::string> names;
  for_each_sensor([&](const Sensor& sensor) { names.push_back(name_of(sensor)); });
  return names;
}

std::vector<std::string> sensors_with(Quantity quantity) {
  std::vector<std::string> names;
  for_each_sensor([&](const Sensor& sensor) {
    const auto components = components_of(sensor);
    if (std::ranges::find(components, quantity) != components.end())
      names.push_back(name_of(sensor));
  });
  return names;
}

std::optional<Sensor> sensor_named(std::string_view name, const Mounting& mounting) {
  std::optional<Sensor> found;
  for_each_sensor([&](const Sensor& sensor) {
    if (name_of(sensor) == name) found = Sensor{sensor.kind, mounting};
  });
  return found;
}

bool fixes_landmark(const Sensor& sensor) {
  return std::visit([]<class Kind>(const Kind& /*one*/) { return FixesLandmark<Kind>; },
                    sensor.kind);
}

Eigen::Vector2d detection_of(const Sensor& sensor, const RangeBearing<double>& from) {
  return std::visit([&](const auto& one) { return one.detection_of(from); }, sensor.kind);
}

/// This function is flattened, since it is called for every landmark near a detection.
[[gnu::flatten]] std::optional<LinearisedDetection> linearised_detection(const Sensor& sensor,
                                                                         const Pose& pose,
                                                                         const Point& landmark) {
  auto seen = std::visit(
      [&](const auto& one) { return one.linearised(sensor.mounting.pose_of(pose), landmark); },
      sensor.kind);
  if (seen && !sensor.mounting.is_none()) {
    seen->by_pose = (seen->by_pose * sensor.mounting.jacobian(pose)).eval();
  }
  return seen;
}

std::optional<PlacedLandmark> placed_landmark(const Sensor& sensor, const Pose& pose,
                                              const Eigen::Vector2d& detection) {
  const Pose from = sensor.mounting.pose_of(pose);
  auto placed = std::visit(
      [&](const auto& one) -> std::optional<PlacedLandmark> {
        if constexpr (requires { one.placed(from, detection); }) {
          return one.placed(from, detection);
        } else {
          return std::nullopt;
        }
      },
      sensor.kind);
  if (placed && !sensor.mounting.is_none()) {
    placed->by_pose = (placed->by_pose * sensor.mounting.jacobian(pose)).eval();
  }
  return placed;
}

Wraps wraps_of(const Sensor& sensor) {
  Wraps wraps{};
  std::ranges::transform(components_of(sensor), wraps.begin(),
                         [](Quantity quantity) { return models::wraps(quantity); });
  return wraps;
}

std::optional<double> distance_in(std::span<const Quantity> components,
                                  const Detection& detection) {
  if (components[0] == Quantity::range) return detection[0];
  if (components[0] == Quantity::forward) return length(detection[0], detection[1]);
  return std::nullopt;
}

}  // namespace montecarta::models
