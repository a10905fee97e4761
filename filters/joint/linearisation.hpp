// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/compressed_gaussian.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <memory>
#include <vector>

namespace montecarta::filters {

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
  /// Turns all points by an angle [rad] about the origin.
  void turn(double angle);
  /// Moves the vehicle by `motion`, as linearised.
  void move(const LinearisedMotion& motion);
  /// Adds a landmark that was initialised at this distance from the point of the vehicle.
  void append(const Eigen::Vector2d& away) { landmarks_.emplace_back(place_of(pose_) + away); }

 private:
  Pose pose_;  ///< point of the vehicle, with the heading of the linearisation
  std::vector<Eigen::Vector2d> landmarks_;
};

/// H times the rotation, for the points of vehicle and landmark [m]: the assumed change of an
/// observation, linearised as `expected`, per rad of a rotation of vehicle and map.
Eigen::Vector2d turned(const ExpectedObservation& expected, const Eigen::Vector2d& place,
                       const Eigen::Vector2d& landmark);

/// The Gaussian of a joint filter and the points at which it may be linearised.
struct LinearisedSystem {
  CompressedGaussian gaussian;
  LinearisationPoints points;
};

/// The linearisation of motion and observations in a joint filter (EQUATIONS 15).
class Linearisation {
 public:
  virtual ~Linearisation() = default;
  /// Called when the Gaussian has just started at `start`.
  virtual void start(const Pose& /*start*/, CompressedGaussian& /*gaussian*/) {}

  virtual LinearisedMotion linearised(const LinearisedSystem& system,
                                      const MotionIncrement& motion) const;
  virtual void move(const MotionIncrement& motion, LinearisedSystem& system) const;
  /// Predicts the detection of a landmark.
  virtual CompressedGaussian::ObservationStatus predict(const LinearisedSystem& system,
                                                        std::size_t slot,
                                                        ExpectedObservation& expected) const;
  /// Vector [m] to the estimated pose from the one at which a new landmark is linearised.
  virtual Eigen::Vector2d offset(const LinearisedSystem& system) const;
  /// Called when all detections of a scan have been used.
  virtual void end_scan(CompressedGaussian& /*gaussian*/) {}
  /// The points of vehicle and landmark about which the linearised system can be rotated.
  virtual ObservationPoint rotation_point(const LinearisedSystem& system, std::size_t slot) const;

  /// Predicted moments of the pose after `motion`, in the map.
  virtual PoseMoments pose_after(const LinearisedSystem& system,
                                 const MotionIncrement& motion) const;
  /// Moments of a landmark in the map.
  virtual LandmarkEstimate landmark(const CompressedGaussian& gaussian, std::size_t slot) const;
  /// Transforms the estimate of the Gaussian to the map.
  virtual void put_in_map(JointEstimate& /*joint*/) const {}
};

/// Linearises at the latest estimate: EKF-SLAM, and RI-EKF-SLAM with its error.
std::unique_ptr<Linearisation> at_estimate();
/// Linearises at the first estimates (Huang, Mourikis, Roumeliotis, ICRA 2008).
std::unique_ptr<Linearisation> at_first_estimates();
/// Linearises at the first estimates, shifted together to the latest ones before each motion
/// (Huang, Mourikis, Roumeliotis, IJRR 2010).
std::unique_ptr<Linearisation> at_constrained_estimates();
/// Linearises at the latest estimate, with errors relative to the vehicle (Castellanos et al., RAS
/// 2007).
std::unique_ptr<Linearisation> relative_to_vehicle();
/// Linearises by regression on sigma points, as in the unscented Kalman filter.
std::unique_ptr<Linearisation> by_sigma_points();

}  // namespace montecarta::filters
