// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/sensor_kinds.hpp"

#include "filters/models/eigen_jacobians.hpp"

#include <cmath>

namespace montecarta::models {
namespace {

/// Returns one row of a range-bearing detection as the first component; there is no second
/// component.
std::optional<LinearisedDetection> one_row(Eigen::Index row, const Pose& sensor,
                                           const Point& landmark) {
  const auto both = RangeBearingSensor::linearised(sensor, landmark);
  if (!both) return std::nullopt;
  LinearisedDetection one{Eigen::Vector2d::Zero(), Matrix23::Zero(), Eigen::Matrix2d::Zero()};
  one.value(0) = both->value(row);
  one.by_pose.row(0) = both->by_pose.row(row);
  one.by_landmark.row(0) = both->by_landmark.row(row);
  return one;
}

/// The columns are the axes forward and left of the sensor, in the map.
Eigen::Matrix2d axes_of(const Pose& sensor) {
  const Direction<double> heading = direction_of(sensor.heading);
  return Eigen::Matrix2d{{heading.cosine, -heading.sine}, {heading.sine, heading.cosine}};
}

}  // namespace

Eigen::Vector2d RangeBearingSensor::detection_of(const RangeBearing<double>& from) {
  return to_vector(from);
}

std::optional<LinearisedDetection> RangeBearingSensor::linearised(const Pose& sensor,
                                                                  const Point& landmark) {
  const auto at = linearised_observation(sensor, landmark);
  if (too_near(at.observation)) return std::nullopt;
  return LinearisedDetection{to_vector(at.observation), pose_jacobian(at), landmark_jacobian(at)};
}

PlacedLandmark RangeBearingSensor::placed(const Pose& sensor, const Eigen::Vector2d& detection) {
  const auto at = linearised_place(sensor, RangeBearing<double>{detection(0), detection(1)});
  return {to_vector(at.point), pose_jacobian(at), observation_jacobian(at)};
}

Eigen::Vector2d BearingSensor::detection_of(const RangeBearing<double>& from) {
  return {from.bearing, 0.0};
}

std::optional<LinearisedDetection> BearingSensor::linearised(const Pose& sensor,
                                                             const Point& landmark) {
  return one_row(1, sensor, landmark);
}

Eigen::Vector2d RangeSensor::detection_of(const RangeBearing<double>& from) {
  return {from.range, 0.0};
}

std::optional<LinearisedDetection> RangeSensor::linearised(const Pose& sensor,
                                                           const Point& landmark) {
  return one_row(0, sensor, landmark);
}

Eigen::Vector2d PositionSensor::detection_of(const RangeBearing<double>& from) {
  return {from.range * std::cos(from.bearing), from.range * std::sin(from.bearing)};
}

std::optional<LinearisedDetection> PositionSensor::linearised(const Pose& sensor,
                                                              const Point& landmark) {
  const Eigen::Matrix2d to_sensor = axes_of(sensor).transpose();
  const Eigen::Vector2d value =
      to_sensor * Eigen::Vector2d(landmark.x - sensor.x, landmark.y - sensor.y);
  LinearisedDetection seen{value, Matrix23::Zero(), to_sensor};
  seen.by_pose << -to_sensor, Eigen::Vector2d(value.y(), -value.x());
  return seen;
}

PlacedLandmark PositionSensor::placed(const Pose& sensor, const Eigen::Vector2d& detection) {
  const Eigen::Matrix2d to_map = axes_of(sensor);
  const Eigen::Vector2d way = to_map * detection;
  PlacedLandmark at{way + place_of(sensor), Matrix23::Zero(), to_map};
  at.by_pose << Eigen::Matrix2d::Identity(), Eigen::Vector2d(-way.y(), way.x());
  return at;
}

}  // namespace montecarta::models
