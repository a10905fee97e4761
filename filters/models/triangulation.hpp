// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/eigen_jacobians.hpp"
#include "filters/models/sensor.hpp"

#include <Eigen/Core>

#include <optional>

/// Landmarks that are fixed by two detections of one component each (EQUATIONS 2). The derivatives
/// are those of the implicit function that the two equations define.
namespace montecarta::models {

/// A landmark that two detections fix.
struct TriangulatedLandmark {
  Eigen::Vector2d point;      ///< [m] position of the landmark
  Eigen::Matrix2d by_first;   ///< derivative by the first point of the map
  Eigen::Matrix2d by_second;  ///< derivative by the second point
  Matrix23 by_pose;           ///< derivative by the pose of the sensor
  Eigen::Matrix2d noise;      ///< [m^2] covariance due to the noise of the detections
};

/// Intersection of the ray from `first` through `second`, two points of the map, with the ray from
/// `sensor` at `bearing` [rad] with `variance` [rad^2]; nullopt if it is not ahead of both origins.
std::optional<TriangulatedLandmark> crossing_of_rays(const Eigen::Vector2d& first,
                                                     const Eigen::Vector2d& second,
                                                     const Pose& sensor, double bearing,
                                                     double variance);

/// Intersection of two circles about points of the map, with radii `ranges` [m] of `variance` [m^2]
/// each, to the left (side = 1) or right (-1) of the line between them; nullopt if there is none.
std::optional<TriangulatedLandmark> crossing_of_circles(const Eigen::Vector2d& first,
                                                        const Eigen::Vector2d& second,
                                                        const Eigen::Vector2d& ranges, double side,
                                                        double variance);

/// Returns whether two bearings or two ranges, each with `variance`, determine a position well
/// enough to be represented by a Gaussian. `covariance` [m^2] is that of the position, `nearest`
/// [m] the smaller of the two distances to it.
bool crosses_well(const Eigen::Matrix2d& covariance, double nearest, bool of_bearings,
                  double variance);

/// The side (1 or -1) on which a landmark is, by D^2 of a detection for either: the one that the
/// detection fits, if clearly better than the other; nullopt if the detection does not decide.
std::optional<double> chosen_side(double left, double right);

/// Returns whether a sensor of one component measures bearings; otherwise it measures ranges.
bool is_of_bearings(const Sensor& sensor);

/// A detection of one component from a known pose of the sensor.
struct Sighting {
  Pose sensor;
  double value;  ///< bearing [rad] or range [m]
};

/// A landmark that two sightings fix (EQUATIONS 15), given the path.
struct Crossing {
  Eigen::Vector2d point;       ///< [m] position of the landmark
  Eigen::Matrix2d covariance;  ///< [m^2] covariance due to the noise of both sightings
};

/// Triangulates landmarks from pairs of detections of one sensor.
class TwoSightings {
 public:
  /// `variance` [rad^2 or m^2] is that of the one component.
  TwoSightings(const Sensor& sensor, double variance);

  /// Returns nullopt if the sightings do not intersect. `side` (1 or -1) chooses one of the two
  /// intersections of ranges; it has no effect on bearings.
  std::optional<Crossing> crossing(const Sighting& first, const Sighting& second,
                                   double side) const;
  /// Returns whether the crossing is determined well enough to be represented by a Gaussian.
  bool cross_well(const Sighting& first, const Sighting& second) const;
  /// D^2 of a third sighting of a landmark at the crossing; infinite if there is none.
  double squared_distance(const Sighting& first, const Sighting& second, double side,
                          const Sighting& third) const;

 private:
  Sensor sensor_;  ///< the sensor without its mounting
  double variance_;
  bool of_bearings_;
};

}  // namespace montecarta::models
