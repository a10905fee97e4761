// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/moments/gaussians.hpp"

#include <Eigen/Core>

namespace montecarta {

/// The motion since poses were last drawn, in the frame of the drawn pose. The vehicle does not
/// know where in the world it is, so this Gaussian is the same for every particle: it is predicted
/// once for all of them and turned to each particle's heading only when it is needed. Exact: equal
/// to one prediction per particle and step, by the extended Kalman filter (SPEC 2.1: advance()) or
/// by sigma points (sigma_motion.hpp).
class MotionIncrement {
 public:
  MotionIncrement() = default;
  MotionIncrement(const Pose& pose, const Eigen::Matrix3d& covariance)
      : pose_(pose), covariance_(covariance) {}

  void restart() { *this = MotionIncrement(); }

  /// One control step of `duration` [s], linearised.
  void advance(const Control& control, double duration, const Belief& belief) {
    const LinearisedMove<double> step = linearised_move(pose_, control, duration, belief.vehicle);
    const Eigen::Matrix3d F = pose_jacobian(step.jacobians);
    Matrix32 G = control_jacobian(step.jacobians);
    G.col(0) *= belief.sigma_speed;
    G.col(1) *= belief.sigma_steer;
    covariance_ = F * covariance_ * F.transpose() + G * G.transpose();
    pose_ = step.pose;
  }

  const Pose& pose() const { return pose_; }
  const Eigen::Matrix3d& covariance() const { return covariance_; }

  /// What a particle that was at `origin` exactly believes now (SPEC 5: P_i accumulates from zero).
  template <class Real>
  [[gnu::always_inline]] PoseGaussian<Real> from(const BasicPose<Real>& origin) const {
    const Direction<Real> d = direction_of(origin.heading);
    return {
        {origin.x + d.cosine * pose_.x - d.sine * pose_.y,
         origin.y + d.sine * pose_.x + d.cosine * pose_.y, wrap(origin.heading + pose_.heading)},
        turned(symmetric_of<Real>(covariance_), d)};
  }

 private:
  Pose pose_;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
};

}  // namespace montecarta
