// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/evidence.hpp"

#include <Eigen/Core>

#include <optional>

namespace montecarta::filters {

/// The sensor that a filter assumes, with the noise of its detections.
class BelievedSensor {
 public:
  /// By default the sensor measures range and bearing at the pose.
  BelievedSensor(const SensorNoise& noise, const Sensor& sensor = {})  // NOLINT: a kind of noise
      : sensor_(sensor), wraps_(wraps_of(sensor)), variances_(noise.first, noise.second) {}
  explicit BelievedSensor(const Belief& belief)
      : BelievedSensor(SensorNoise::of(belief), belief.sensor) {}

  /// {component} variances of a detection.
  const Eigen::Vector2d& variances() const { return variances_; }
  /// Returns whether its detections are polar coordinates in the frame of the vehicle.
  bool is_polar() const {
    return std::holds_alternative<RangeBearingSensor>(sensor_.kind) && sensor_.mounting.is_none();
  }
  /// The predicted detection from a vehicle at `pose`; nullopt if the landmark is too near.
  std::optional<LinearisedDetection> linearised(const Pose& pose, const Point& landmark) const {
    return linearised_detection(sensor_, pose, landmark);
  }
  /// The landmark that a detection from a vehicle at `pose` fixes.
  PlacedLandmark placed(const Pose& pose, const Eigen::Vector2d& detection) const {
    return placed_landmark(sensor_, pose, detection).value();
  }
  /// Detected minus predicted, with angles wrapped.
  Eigen::Vector2d residual(const Eigen::Vector2d& detected,
                           const Eigen::Vector2d& predicted) const {
    return models::residual(detected, predicted, wraps_);
  }

 private:
  Sensor sensor_;
  Wraps wraps_;
  Eigen::Vector2d variances_;
};

}  // namespace montecarta::filters
