// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"
#include "engine/core/prior.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/range_bearing.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// The Cramer-Rao bound on pose and landmarks together, as a covariance that is propagated along a
/// known path: the recursion of a Kalman filter with all Jacobians at the truth. A landmark is
/// unknown before its first observation; if one detection does not fix it, its standard deviation
/// is a kilometre. The pose is known exactly at the start, unless there is a prior.
class JointBound {
 public:
  /// Makes room for all `landmarks`; nothing is allocated later. `control_noise` is that of the
  /// vehicle, `observation_variance` that of the components of the sensor.
  JointBound(std::size_t landmarks, const Vehicle& vehicle, const ControlNoise& control_noise,
             const Eigen::Vector2d& observation_variance, const Sensor& sensor = {});

  /// Begins with a map and a start that are known with these deviations.
  void start_from(const PriorDeviations& prior);

  /// Propagates the bound through one control step from the true `pose`; returns the pose after it.
  Pose move(const Pose& pose, const Control& control, double duration);

  /// A detected landmark with its true position [m].
  struct SeenLandmark {
    std::size_t identity = 0;
    Point point;
  };
  /// Updates the bound with a scan from the true `pose` that detects `landmarks`. Returns false if
  /// the noise is too small for the computation; the bound is unusable then.
  [[nodiscard]] bool scan(const Pose& pose, std::span<const SeenLandmark> landmarks);

  /// Updates the bound with a fix of the position of this variance [m^2]. Returns false as scan()
  /// does.
  [[nodiscard]] bool fix(double variance);

  const Eigen::Matrix3d& pose() const { return pose_; }
  /// [m^2] Mean squared position error of the landmarks that the detections locate; NaN if there
  /// are none.
  double mean_map_variance() const;

 private:
  void add_increment_noise(const Pose& pose, const Control& control, double duration);
  void finish_motion();
  [[nodiscard]] bool correct(const Pose& pose, std::span<const SeenLandmark> landmarks);
  [[nodiscard]] bool subtract(const Eigen::MatrixXd& gain, const Eigen::MatrixXd& S);
  void append(const Pose& pose, const SeenLandmark& landmark);
  void append_unknown(const SeenLandmark& landmark);
  Eigen::VectorXd column(Eigen::Index j) const;
  Eigen::Index& row_of(std::size_t identity) { return row_[identity]; }

  Vehicle vehicle_;
  ControlNoise control_noise_;
  Eigen::Vector2d observation_variance_;
  Sensor sensor_;
  Eigen::Matrix3d pose_ = Eigen::Matrix3d::Zero();  ///< covariance of the pose, symmetric
  double pending_x_heading_ = 0.0;                  ///< [m/rad] element of Fx since the last scan
  double pending_y_heading_ = 0.0;                  ///< [m/rad] element of Fx since the last scan
  Eigen::MatrixXd joint_;  ///< lower triangle of the joint covariance; its pose block is in pose_
  Eigen::Index size_ = 3;  ///< number of rows in use
  std::vector<Eigen::Index> row_;  ///< {landmark} its first row in `joint_`; 0 if it was never seen
};

}  // namespace montecarta::analysis
