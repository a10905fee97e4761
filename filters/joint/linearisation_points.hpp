// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "filters/joint/compressed_gaussian.hpp"

#include <Eigen/Core>

#include <cstddef>
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

}  // namespace montecarta::filters
