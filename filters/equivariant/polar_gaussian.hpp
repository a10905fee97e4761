// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/joint_gaussian.hpp"
#include "filters/moments/motion_increment.hpp"
#include "filters/setup/filter_setup.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace montecarta::filters {

/// A Gaussian over the errors of the equivariant filter with polar symmetry (EQUATIONS (15.22)):
/// that of the pose moves vehicle and map together, as in the right-invariant filter, and that of a
/// landmark is the error of the logarithm of its range [1] and of its bearing [rad], as seen from
/// the vehicle. A detection of range and bearing is linear in them. Errors are about the start, so
/// that nothing depends on where it is in the world; all results are in the map.
class PolarGaussian {
 public:
  explicit PolarGaussian(const Belief& belief) : belief_(belief) {}

  /// Starts with the vehicle exactly at `start` and no landmarks.
  void start(const Pose& start);
  void move(const MotionIncrement& motion);
  /// Predicted moments of the pose after `motion`.
  PoseMoments pose_after(const MotionIncrement& motion) const;

  /// The predicted detection of a landmark.
  struct Expected {
    double range, bearing;    ///< [m, rad]
    InnovationFactor factor;  ///< factor of the covariance S of innovation()

    /// (log of the ratio of the ranges [1], difference of the bearings [rad]).
    Eigen::Vector2d innovation(const Eigen::Vector2d& detected) const;
  };
  /// Returns nullopt if S is not positive definite.
  std::optional<Expected> expected(std::size_t slot) const;
  /// Conditions on an innovation of the landmark `slot`, which was expected like this.
  void update_with(std::size_t slot, const Eigen::Vector2d& innovation, const Expected& expected);
  /// Adds a landmark at a detection (range [m], bearing [rad]).
  void append(const Eigen::Vector2d& detected);

  std::size_t landmarks() const { return places_.size(); }
  LandmarkEstimate landmark(std::size_t slot) const;
  /// Pose and all landmarks, in the order in which they were added.
  JointEstimate joint() const;

 private:
  static Eigen::Index row_of(std::size_t slot) { return 3 + 2 * static_cast<Eigen::Index>(slot); }
  Eigen::Index rows() const { return row_of(places_.size()); }
  void copy_columns(std::size_t slot);
  Eigen::Matrix<double, 2, 3> by_frame(const Eigen::Vector2d& place) const;
  Eigen::Vector2d place_from_start(std::size_t slot) const;
  Eigen::Matrix2d by_own_error(std::size_t slot) const;

  Belief belief_;
  Pose start_;                           ///< in the map
  Pose pose_;                            ///< in the frame of the start
  std::vector<Eigen::Vector2d> places_;  ///< [m] {slot} landmarks in the frame of the vehicle
  Eigen::MatrixXd covariance_;  ///< lower triangle of blocks; with room for landmarks to come
  Eigen::Matrix<double, Eigen::Dynamic, 2> columns_;  ///< scratch: {row} columns, or W
  std::vector<Eigen::Matrix<double, 2, 3>> noise_;    ///< scratch: {slot}
  std::vector<Eigen::Matrix2d> kept_;                 ///< scratch: {slot}
};

}  // namespace montecarta::filters
