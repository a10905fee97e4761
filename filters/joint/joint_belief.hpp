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

/// Where a joint filter linearises motion and observations (EQUATIONS 15).
enum class Linearisation {
  estimate,     ///< at the latest estimate: EKF-SLAM
  first,        ///< at the first estimates: Huang, Mourikis, Roumeliotis, ICRA 2008
  constrained,  ///< at these, shifted together to the latest ones: the same, IJRR 2010
  relative,     ///< at the latest estimate, errors relative to the vehicle: Castellanos et al. 2007
  regression    ///< nowhere: by regression on sigma points, as in the unscented Kalman filter
};

/// The rotation of the whole in the linearised system: where the true system turns every point p of
/// vehicle and map by J p, its linearisation turns the points held here, whichever way it is
/// linearised (EQUATIONS (15.9)). A system that is linearised at these points has the right
/// unobservable directions. Landmarks are numbered in order of initialisation.
class LinearisationPoints {
 public:
  /// The vehicle stands exactly at `start`, no landmarks.
  void start(const Pose& start);
  const Pose& pose() const { return pose_; }
  const Eigen::Vector2d& landmark(std::size_t slot) const { return landmarks_[slot]; }
  /// [m] from the vehicle's point to that place.
  Eigen::Vector2d behind(const Pose& place) const;

  /// [m] what shifts all points together to the estimates of `gaussian`, in least squares.
  Eigen::Vector2d shift_to(const CompressedGaussian& gaussian) const;
  void shift(const Eigen::Vector2d& way);
  /// The vehicle moved by `motion`, as it was linearised.
  void move(const LinearisedMotion& motion);
  /// A landmark was initialised that far from the vehicle's point.
  void append(const Eigen::Vector2d& away) { landmarks_.emplace_back(place_of(pose_) + away); }

 private:
  Pose pose_;  ///< and the heading that it is linearised at
  std::vector<Eigen::Vector2d> landmarks_;
};

/// H times the column of the rotation, with the points of vehicle and landmark [m]: by how much an
/// observation, linearised as `expected`, is taken to change where the whole turns [per rad].
Eigen::Vector2d turned(const ExpectedObservation& expected, const Eigen::Vector2d& place,
                       const Eigen::Vector2d& landmark);

/// One belief about the whole world: a joint Gaussian over pose and map, and what its detections
/// are taken for. Detections are used one by one in the order of the scan.
class JointBelief {
 public:
  /// `iterations`: of CompressedGaussian::update_with(); `moments`: of all that it reports.
  JointBelief(const FilterSetup& setup, Retraction retraction, int iterations,
              Moments moments = Moments::map,
              Linearisation linearisation = Linearisation::estimate);

  /// The vehicle stands at `start`, no landmarks.
  void start(const Pose& start);
  /// The vehicle moved by `motion`; decides which landmarks `scan` then shows, and conditions the
  /// Gaussian on them.
  void update_with(const MotionIncrement& motion, Scan scan);
  /// Adds the landmarks that this scan, just used, shows for the first time. If one detection does
  /// not fix a landmark, takes its initialisation a step further instead (DelayedInitialisation).
  /// Throws RunError where the map has run away.
  void initialise_landmarks(Scan scan);
  /// CompressedGaussian::replace().
  void replace(const PoseMoments& pose, const MapMoments& map) { gaussian_.replace(pose, map); }

  const CompressedGaussian& gaussian() const { return gaussian_; }
  /// What the pose would be after `motion`.
  PoseMoments pose_after(const MotionIncrement& motion) const;
  /// In the map.
  std::size_t landmarks() const { return point_of_.size(); }
  /// The k-th landmark: of identity k with known association, else the k-th initialised.
  std::optional<LandmarkEstimate> landmark(std::size_t k) const;
  /// Of the pose and the first `landmarks` of these; NaN where the map has none.
  JointEstimate joint(std::size_t landmarks) const;

  /// What the last scan was to this belief.
  struct Outcome {
    double log_likelihood = 0.0;
    std::uint32_t faults = 0;
  };
  const Outcome& outcome() const { return outcome_; }
  const MapAssociation& association() const { return association_; }
  /// [1/rad^2] what all detections since the start are taken to tell of the heading of the whole,
  /// which none of them can (EQUATIONS (15.11)); NaN of a sensor that does not fix landmarks.
  double rotation_information() const {
    return fixes_landmark(sensor_) ? rotation_information_
                                   : std::numeric_limits<double>::quiet_NaN();
  }
  /// A detection that updated it.
  struct UsedDetection {
    std::size_t detection;  ///< its place in the scan
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
  std::vector<char> advancing_;  ///< scratch: {detection} whether it takes a landmark further
  int iterations_;
  Moments moments_;
  Linearisation linearisation_;
  Retraction retraction_;
  LinearisationPoints points_;  ///< of a sensor that fixes landmarks
  RobocentricFrame frame_;      ///< where errors are relative to the vehicle
  Eigen::Vector2d sigma_;       ///< of the components of a detection
  double rotation_information_ = 0.0;
  std::vector<NearestSearch> searches_;  ///< scratch
  std::vector<std::uint32_t> matched_;   ///< scratch: slots that the current scan needs
  std::vector<UsedDetection> used_detections_;
  Outcome outcome_;
};

}  // namespace montecarta::filters
