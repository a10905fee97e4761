// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/detection_component.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/models/range_bearing.hpp"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <optional>

/// The sensors that there are (EQUATIONS 2). sensor.hpp lists them and says what one must offer.
namespace montecarta::models {

/// What a sensor should see of a landmark, with derivatives. Rows of components that the sensor
/// does not have are 0.
struct LinearisedDetection {
  Eigen::Vector2d value;
  Matrix23 by_pose;  ///< of the sensor
  Eigen::Matrix2d by_landmark;
};

/// Where one detection places a landmark, with derivatives.
struct PlacedLandmark {
  Eigen::Vector2d point;  ///< [m]
  Matrix23 by_pose;       ///< of the sensor
  Eigen::Matrix2d by_detection;
};

struct RangeBearingSensor {
  static constexpr const char* kName = "range_bearing";
  static constexpr std::array kComponents = {Quantity::range, Quantity::bearing};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from) { return to_vector(from); }
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark) {
    const auto at = linearised_observation(sensor, landmark);
    if (too_near(at.observation)) return std::nullopt;
    return LinearisedDetection{to_vector(at.observation), pose_jacobian(at), landmark_jacobian(at)};
  }
  static PlacedLandmark placed(const Pose& sensor, const Eigen::Vector2d& detection) {
    const auto at = linearised_place(sensor, RangeBearing<double>{detection(0), detection(1)});
    return {to_vector(at.point), pose_jacobian(at), observation_jacobian(at)};
  }
};

/// One row of a range-bearing detection, as the first component; the second does not exist.
inline std::optional<LinearisedDetection> one_row(Eigen::Index row, const Pose& sensor,
                                                  const Point& landmark) {
  const auto both = RangeBearingSensor::linearised(sensor, landmark);
  if (!both) return std::nullopt;
  LinearisedDetection one{Eigen::Vector2d::Zero(), Matrix23::Zero(), Eigen::Matrix2d::Zero()};
  one.value(0) = both->value(row);
  one.by_pose.row(0) = both->by_pose.row(row);
  one.by_landmark.row(0) = both->by_landmark.row(row);
  return one;
}

struct BearingSensor {
  static constexpr const char* kName = "bearing_only";
  static constexpr std::array kComponents = {Quantity::bearing};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from) {
    return {from.bearing, 0.0};
  }
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark) {
    return one_row(1, sensor, landmark);
  }
};

struct RangeSensor {
  static constexpr const char* kName = "range_only";
  static constexpr std::array kComponents = {Quantity::range};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from) {
    return {from.range, 0.0};
  }
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark) {
    return one_row(0, sensor, landmark);
  }
};

/// The landmark's place in the frame of the sensor: forward, left.
struct PositionSensor {
  static constexpr const char* kName = "position";
  static constexpr std::array kComponents = {Quantity::forward, Quantity::left};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from) {
    return {from.range * std::cos(from.bearing), from.range * std::sin(from.bearing)};
  }
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark) {
    const Eigen::Matrix2d to_sensor = axes_of(sensor).transpose();
    const Eigen::Vector2d value =
        to_sensor * Eigen::Vector2d(landmark.x - sensor.x, landmark.y - sensor.y);
    LinearisedDetection seen{value, Matrix23::Zero(), to_sensor};
    seen.by_pose << -to_sensor, Eigen::Vector2d(value.y(), -value.x());
    return seen;
  }
  static PlacedLandmark placed(const Pose& sensor, const Eigen::Vector2d& detection) {
    const Eigen::Matrix2d to_map = axes_of(sensor);
    const Eigen::Vector2d way = to_map * detection;
    PlacedLandmark at{way + place_of(sensor), Matrix23::Zero(), to_map};
    at.by_pose << Eigen::Matrix2d::Identity(), Eigen::Vector2d(-way.y(), way.x());
    return at;
  }

 private:
  /// Columns: forward and left in the map.
  static Eigen::Matrix2d axes_of(const Pose& sensor) {
    const Direction<double> heading = direction_of(sensor.heading);
    return Eigen::Matrix2d{{heading.cosine, -heading.sine}, {heading.sine, heading.cosine}};
  }
};

}  // namespace montecarta::models
