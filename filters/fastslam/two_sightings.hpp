// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/sensor.hpp"

#include <Eigen/Core>

#include <optional>

namespace montecarta::filters {

/// A detection of one component, from a pose of the sensor that is known.
struct Sighting {
  Pose sensor;
  double value;  ///< bearing [rad] or range [m]
};

/// Where two sightings place a landmark (EQUATIONS 15), given the path.
struct Crossing {
  Eigen::Vector2d point;       ///< [m]
  Eigen::Matrix2d covariance;  ///< [m^2] of the noise of both
};

/// How pairs of detections of one sensor place landmarks.
class TwoSightings {
 public:
  /// `variance` [rad^2 or m^2] of the one component.
  TwoSightings(const Sensor& sensor, double variance);

  bool of_bearings() const { return of_bearings_; }
  /// Nullopt where they do not cross; of ranges on one of two sides (1, -1), of bearings either is
  /// the same.
  std::optional<Crossing> crossing(const Sighting& first, const Sighting& second,
                                   double side) const;
  /// Whether the crossing is known well enough to be a Gaussian.
  bool cross_well(const Sighting& first, const Sighting& second) const;
  /// D^2 of a third sighting, were the landmark at the crossing; infinite where there is none.
  double squared_distance(const Sighting& first, const Sighting& second, double side,
                          const Sighting& third) const;

 private:
  Sensor sensor_;  ///< at its own pose
  double variance_;
  bool of_bearings_;
};

}  // namespace montecarta::filters
