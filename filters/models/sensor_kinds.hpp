// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/numbers/angle.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/models/range_bearing.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <optional>

/// The sensors that there are (EQUATIONS 2). sensor.hpp lists them and says what one must offer.
namespace montecarta::models {

/// What a component of a detection is.
enum class Quantity { range, bearing, forward, left };

/// One component of a detection, as messages, logs and study files name it. Keys that end in _deg
/// are in degrees, everything else in SI units.
struct DetectionName {
  const char* name;        ///< "range": in messages and errors
  const char* column;      ///< "range_m": in detections.csv
  bool wraps;              ///< whether it is an angle
  bool is_positive;        ///< whether it must be above 0
  double most;             ///< greatest size that a log may hold
  const char* limit;       ///< "metres, a finite number": why a log with more is refused
  const char* sigma;       ///< "sigma_range": key of its noise
  const char* unit;        ///< of that key
  const char* usual;       ///< value of that key where nothing is said
  double most_sigma;       ///< greatest value of that key
  const char* noise_text;  ///< what that key means
  const char* example;     ///< value of that key that an error suggests
};

/// In the order of the enumerators.
inline constexpr std::array<DetectionName, 4> kDetectionNames = {
    {{"range", "range_m", false, true, 1e6, "metres, a finite number", "sigma_range", "m", "0.1",
      1000, "noise of a range", "0.5"},
     {"bearing", "bearing_rad", true, false, 2 * kPi, "radians relative to the heading",
      "sigma_bearing_deg", "deg", "1", 180, "noise of a bearing", "1.5"},
     {"forward", "forward_m", false, false, 1e6, "metres, a finite number",
      "sigma_position_forward", "m", "0.1", 1000, "noise of a position along the sensor's heading",
      "0.1"},
     {"left", "left_m", false, false, 1e6, "metres, a finite number", "sigma_position_left", "m",
      "0.1", 1000, "noise of a position across the sensor's heading", "0.1"}}};

constexpr const DetectionName& name_of(Quantity quantity) {
  return kDetectionNames[static_cast<std::size_t>(quantity)];
}

/// The standard deviation that `owner` (a belief, a scenario) has of a quantity.
template <class Owner>
auto& deviation_of(Quantity quantity, Owner& owner) {
  switch (quantity) {
    case Quantity::range:
      return owner.sigma_range;
    case Quantity::bearing:
      return owner.sigma_bearing;
    case Quantity::forward:
      return owner.sigma_forward;
    case Quantity::left:
      break;
  }
  return owner.sigma_left;
}

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

/// The landmark's place in the frame of the sensor: forward, left.
struct PositionSensor {
  static constexpr const char* kName = "position";
  static constexpr std::array kComponents = {Quantity::forward, Quantity::left};

  static Eigen::Vector2d detection_of(const RangeBearing<double>& from);
  static std::optional<LinearisedDetection> linearised(const Pose& sensor, const Point& landmark);
  static PlacedLandmark placed(const Pose& sensor, const Eigen::Vector2d& detection);
};

}  // namespace montecarta::models
