// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "filters/association/map_association.hpp"
#include "filters/joint/compressed_gaussian.hpp"
#include "filters/joint/delayed_initialisation.hpp"
#include "filters/joint/retraction.hpp"
#include "filters/joint/robocentric_frame.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::filters {

/// The point at which a joint filter linearises motion and observations (EQUATIONS 15).
enum class Linearisation {
  estimate,     ///< the latest estimate: EKF-SLAM
  first,        ///< the first estimates: Huang, Mourikis, Roumeliotis, ICRA 2008
  constrained,  ///< these, shifted together to the latest estimates: Huang et al., IJRR 2010
  relative,     ///< the latest estimate, errors relative to the vehicle: Castellanos et al. 2007
  regression    ///< none: regression on sigma points, as in the unscented Kalman filter
};

/// The rotation of vehicle and map in the linearised system. The true system moves every point p by
/// J p in such a rotation; any linearisation of it moves the points kept here (EQUATIONS (15.9)). A
/// system that is linearised at these points has the right unobservable directions. Landmarks are
/// numbered in order of initialisation.
class LinearisationPoints {
 public:
  /// Starts with the vehicle exactly at `start` and no landmarks.
  void start(const Pose& start);
  const Pose& pose() const { return pose_; }
  const Eigen::Vector2d& landmark(std::size_t slot) const { return landmarks_[slot]; }
  /// Vector [m] from the point of the vehicle to `place`.
  Eigen::Vector2d behind(const Pose& place) const;

  /// Common shift [m] of all points that brings them nearest to `gaussian`, in least squares.
  Eigen::Vector2d shift_to(const CompressedGaussian& gaussian) const;
  void shift(const Eigen::Vector2d& way);
  /// Moves the vehicle by `motion`, as linearised.
  void move(const LinearisedMotion& motion);
  /// Adds a landmark that was initialised at this distance from the point of the vehicle.
  void append(const Eigen::Vector2d& away) { landmarks_.emplace_back(place_of(pose_) + away); }

 private:
  Pose pose_;  ///< includes the heading of the linearisation
  std::vector<Eigen::Vector2d> landmarks_;
};

/// H times the rotation, for the points of vehicle and landmark [m]: the assumed change of an
/// observation, linearised as `expected`, per rad of a rotation of vehicle and map.
Eigen::Vector2d turned(const ExpectedObservation& expected, const Eigen::Vector2d& place,
                       const Eigen::Vector2d& landmark);

/// A joint Gaussian over pose and map with the association of its detections. Detections are used
/// one by one in the order of the scan.
class JointBelief {
 public:
  /// `iterations` is that of CompressedGaussian::update_with(); `moments` applies to all reports.
  JointBelief(const FilterSetup& setup, Retraction retraction, int iterations,
              Moments moments = Moments::map,
              Linearisation linearisation = Linearisation::estimate);

  /// Starts with the vehicle at `start` and no landmarks.
  void start(const Pose& start);
  /// Predicts by `motion`, associates the scan, and conditions the Gaussian on the matched
  /// detections.
  void update_with(const MotionIncrement& motion, Scan scan);
  /// Initialises the landmarks that the scan of the last update_with() shows for the first time. If
  /// one detection does not fix a landmark, advances its DelayedInitialisation instead. Throws
  /// RunError if the map has grown beyond its limit.
  void initialise_landmarks(Scan scan);
  void replace(const PoseMoments& pose, const MapMoments& map) { gaussian_.replace(pose, map); }

  const CompressedGaussian& gaussian() const { return gaussian_; }
  /// Predicted moments of the pose after `motion`.
  PoseMoments pose_after(const MotionIncrement& motion) const;
  /// Number of landmarks in the map.
  std::size_t landmarks() const { return point_of_.size(); }
  /// Landmark k: the one of identity k with known association, else the k-th initialised.
  std::optional<LandmarkEstimate> landmark(std::size_t k) const;
  /// Pose and landmarks 0 to `landmarks` - 1; NaN for landmarks that the map does not have.
  JointEstimate joint(std::size_t landmarks) const;

  /// Results of the last scan.
  struct Outcome {
    double log_likelihood = 0.0;
    std::uint32_t faults = 0;
  };
  const Outcome& outcome() const { return outcome_; }
  const MapAssociation& association() const { return association_; }
  /// Information [1/rad^2] about a rotation of vehicle and map that the linearised system gains
  /// from all detections since the start, though they have none (EQUATIONS (15.11)). NaN if one
  /// detection does not fix a landmark.
  double rotation_information() const {
    return fixes_landmark(sensor_) ? rotation_information_
                                   : std::numeric_limits<double>::quiet_NaN();
  }
  /// A detection that updated the belief.
  struct UsedDetection {
    std::size_t detection;  ///< its index in the scan
    Eigen::Vector2d innovation;
    Eigen::Matrix2d covariance;  ///< S = H P H' + R
  };
  std::span<const UsedDetection> used_detections() const { return used_detections_; }

 private:
  bool has_own_points() const {
    return linearisation_ == Linearisation::first || linearisation_ == Linearisation::constrained;
  }
  bool is_robocentric() const { return linearisation_ == Linearisation::relative; }
  bool regresses() const { return linearisation_ == Linearisation::regression; }
  Eigen::Vector2d shift_of_points() const;
  LinearisedMotion linearised(const MotionIncrement& motion) const;
  void move(const MotionIncrement& motion);
  std::optional<ObservationPoint> observation_point(std::size_t slot) const;
  ObservationPoint rotation_point(std::size_t slot) const;
  double reach_of(Scan scan) const;
  void pair_nearest(Scan scan);
  void select_matched();
  bool look_at(std::size_t slot, ExpectedObservation& expected);
  void update_with(std::size_t k, const Detection& detection);

  void find_advancing(Scan scan);
  void add_landmark(const Detection& fresh, std::uint32_t point);
  void place_landmark(const Detection& fresh);

  Sensor sensor_;
  MapAssociation association_;
  CompressedGaussian gaussian_;
  std::vector<std::uint32_t> point_of_;  ///< {landmark} its slot in the Gaussian
  DelayedInitialisation delayed_;
  std::vector<char> advancing_;  ///< scratch: {detection} whether it advances a landmark
  int iterations_;
  Moments moments_;
  Linearisation linearisation_;
  Retraction retraction_;
  LinearisationPoints points_;  ///< used if the sensor fixes landmarks
  RobocentricFrame frame_;      ///< used if errors are relative to the vehicle
  Eigen::Vector2d sigma_;       ///< deviations of the components of a detection
  double rotation_information_ = 0.0;
  std::vector<NearestSearch> searches_;  ///< scratch
  std::vector<std::uint32_t> matched_;   ///< scratch: slots that the current scan needs
  std::vector<UsedDetection> used_detections_;
  Outcome outcome_;
};

}  // namespace montecarta::filters
