// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/eigen_jacobians.hpp"
#include "filters/models/sensor.hpp"

#include <Eigen/Core>

#include <optional>

/// Where two detections of one number each place a landmark (EQUATIONS 2). The derivatives are
/// those of the two equations that define the place.
namespace montecarta::models {

/// A landmark that two detections fix.
struct TriangulatedLandmark {
  Eigen::Vector2d point;      ///< [m]
  Eigen::Matrix2d by_first;   ///< by a point of the map
  Eigen::Matrix2d by_second;  ///< likewise
  Matrix23 by_pose;           ///< of the sensor
  Eigen::Matrix2d noise;      ///< [m^2] from the noise of detections
};

/// The ray from `first` through `second`, two points of the map, cuts the one that `sensor` sees at
/// `bearing` [rad] with `variance` [rad^2]; nullopt where they do not meet ahead of both.
std::optional<TriangulatedLandmark> crossing_of_rays(const Eigen::Vector2d& first,
                                                     const Eigen::Vector2d& second,
                                                     const Pose& sensor, double bearing,
                                                     double variance);

/// Two circles about points of the map, of `ranges` [m] each with `variance` [m^2], cut left (side
/// = 1) or right (-1) of the way from the first to the second; nullopt where they do not cut.
std::optional<TriangulatedLandmark> crossing_of_circles(const Eigen::Vector2d& first,
                                                        const Eigen::Vector2d& second,
                                                        const Eigen::Vector2d& ranges, double side,
                                                        double variance);

/// Whether a place is determined well by two bearings or two ranges, each with `variance`: its
/// covariance [m^2], from the first detection, is small enough for a Gaussian. `nearest` [m]: the
/// smaller distance from which it was seen.
bool crosses_well(const Eigen::Matrix2d& covariance, double nearest, bool of_bearings,
                  double variance);

/// On which of two sides (1, -1) a landmark is, by D^2 of a detection for either: that which it
/// fits, and so much better than the other; nullopt where it does not tell.
std::optional<double> chosen_side(double left, double right);

/// Of a sensor of one component; else its detections are ranges.
bool is_of_bearings(const Sensor& sensor);

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

}  // namespace montecarta::models
