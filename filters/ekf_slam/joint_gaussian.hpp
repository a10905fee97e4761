// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/slam_filter.hpp"
#include "filters/ekf_slam/innovation.hpp"
#include "filters/ekf_slam/retraction.hpp"
#include "filters/factory.hpp"
#include "filters/models/range_bearing.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>

namespace montecarta {

/// A landmark as it should be seen, with what weighs a detection of it.
struct ExpectedSight {
  LinearisedSight<double> sight;
  InnovationFactor innovation;  ///< of S = H P H' + R
};

/// One Gaussian over the pose and all landmarks: the state of EKF-SLAM (SPEC 24). Its covariance is
/// kept in three parts, [pose cross'; cross map], exactly symmetric. Landmarks are numbered in
/// order of birth.
///
/// The invariant error of Barrau turns pose and map together: xi = e - J p e_heading for every
/// point p, J = [0 -1; 1 0]. Held is the covariance of e, in the map frame; it is that of xi at the
/// present estimate. A prediction is then the same for both errors, since Fx carries xi unchanged.
/// A detection is not: xi keeps its covariance while the estimate steps, so that of e is carried
/// along (transport()).
class JointGaussian {
 public:
  /// `room` landmarks fit without allocation; it grows beyond.
  JointGaussian(const Belief& belief, Retraction retraction, std::size_t room);

  /// Stands exactly at `start` with an empty map.
  void start(const Pose& start);
  /// One control step. The pose block moves on at once, the rest waits for finish_motion().
  void move(const Control& control, double duration);
  /// Carries the correlations of pose and landmarks through the steps since the last scan: Fx of
  /// several steps is again [1 0 a; 0 1 b; 0 0 1] with a and b their sums, so this is exact. Before
  /// any use of the map.
  void finish_motion();

  const PoseMoments& pose() const { return pose_; }
  std::size_t landmarks() const { return n_landmarks_; }
  LandmarkEstimate landmark(std::size_t slot) const;

  /// What a detection of landmark `slot` is weighed by; `faulty` where S is not positive definite.
  enum class Trouble { none, too_near, faulty };
  [[nodiscard]] Trouble look_at(std::size_t slot, ExpectedSight& expected) const;
  /// Conditions the Gaussian on a detection of landmark `slot`; returns v' S^-1 v.
  double absorb(std::size_t slot, const ExpectedSight& expected, const Eigen::Vector2d& innovation);
  /// Adds a landmark seen so, correlated with everything the pose is correlated with.
  void append(const RangeBearing<double>& sight);

 private:
  using Columns2 = Eigen::Matrix<double, Eigen::Dynamic, 2>;
  using Columns3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  Eigen::Index rows() const;
  void grow(std::size_t room);
  Eigen::Matrix2d innovation_covariance(std::size_t slot, const LinearisedSight<double>& at) const;
  void whiten_gain(std::size_t slot, const ExpectedSight& expected);
  void subtract_information();
  void step(const Eigen::Vector2d& white);
  void transport(const Eigen::Vector2d& pose_step);
  void transport_map(double heading_variance);

  Belief belief_;
  Retraction retraction_;
  PoseMoments pose_;
  double pending_x_heading_ = 0.0;  ///< [m/rad] element (x, heading) of Fx since the last scan
  double pending_y_heading_ = 0.0;  ///< [m/rad]
  std::size_t n_landmarks_ = 0;
  Eigen::VectorXd map_mean_;               ///< [m]
  Columns3 cross_;                         ///< covariance of landmarks with (x, y, heading)
  Eigen::MatrixXd map_;                    ///< covariance of landmarks
  Columns2 gain_map_;                      ///< P H' L^-T, rows of the map
  Eigen::Matrix<double, 3, 2> gain_pose_;  ///< the same, rows of the pose
  Eigen::Matrix2Xd map_step_;              ///< [m] how one detection moves the landmarks
};

}  // namespace montecarta
