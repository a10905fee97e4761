// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/parameter.hpp"
#include "filters/models/range_bearing.hpp"

#include <Eigen/Core>

#include <array>
#include <optional>

/// The sensors (EQUATIONS 2). sensor.hpp lists them and the members that a sensor must have.
namespace montecarta::models {

/// The standard deviation of a quantity in `owner` (a belief or a scenario).
template <class Owner>
auto& deviation_of(Quantity quantity, Owner& owner) {
  switch (quantity) {
    case Quantity::range:
      return owner.sigma_range;
    case Quantity::bearing:
      return owner.sigma_bearing;
    case Quantity::forward:
      return owner.sigma_forward;
    default:
      return owner.sigma_left;
  }
}

/// A predicted detection with its derivatives. Rows of components that the sensor does not have are
/// 0.
struct LinearisedDetection {
  Eigen::Vector2d value;
  Eigen::Matrix<double, 2, 3> by_pose;  ///< derivative by the pose of the sensor
  Eigen::Matrix2d by_landmark;
};

/// The landmark that one detection fixes, with derivatives.
struct PlacedLandmark {
  Eigen::Vector2d point;                ///< [m] position of the landmark
  Eigen::Matrix<double, 2, 3> by_pose;  ///< derivative by the pose of the sensor
  Eigen::Matrix2d by_detection;
};

struct RangeBearingSensor {
  static constexpr const char* kName = "range_bearing";
  static constexpr std::array kComponents = {Quantity::range, Quantity::bearing};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from);
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark);
  static PlacedLandmark placed(const Pose& sensor, const Eigen::Vector2d& detection);
};

struct BearingSensor {
  static constexpr const char* kName = "bearing_only";
  static constexpr std::array kComponents = {Quantity::bearing};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from);
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark);
};

struct RangeSensor {
  static constexpr const char* kName = "range_only";
  static constexpr std::array kComponents = {Quantity::range};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from);
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark);
};

/// Measures the position of the landmark in the frame of the sensor (forward, left).
struct PositionSensor {
  static constexpr const char* kName = "position";
  static constexpr std::array kComponents = {Quantity::forward, Quantity::left};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from);
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark);
  static PlacedLandmark placed(const Pose& sensor, const Eigen::Vector2d& detection);
};

}  // namespace montecarta::models
