// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/ekf_slam.hpp"

#include <vector>

namespace montecarta::filters::plain {

/// First-estimates Jacobian EKF-SLAM (EQUATIONS 15; Huang, Mourikis and Roumeliotis 2008). It is
/// EKF-SLAM with derivatives at the first estimate of every pose and landmark, so that a turn of
/// pose and map stays unobservable in the linearised system.
class FejEkfSlam : public EkfSlam {
 public:
  using EkfSlam::EkfSlam;

  void start(const Pose& start) override {
    EkfSlam::start(start);
    n_x_ = mean_.head<2>();
    n_l_.clear();
    is_updated_ = false;
  }

  /// Fx is that of a motion that began at n_x: w = p^- - n_x, then n_x <- p^- (EQUATIONS (15.10)).
  /// A vehicle that stands still is not linearised again.
  void predict(const StepContext& /*context*/, const Control& u, double duration) override {
    const auto step = linearised_move(pose(), u, duration, setup_.belief.vehicle);
    const ControlJacobian Fu = control_jacobian(step.jacobians);
    const Matrix<3> noise = Fu * control_noise(setup_.belief, u) * Fu.transpose() +
                            increment_covariance(setup_.belief, mean_(2), u, duration);
    if (to_vector(step.pose) == mean_.head<3>() && noise.isZero(0.0)) return;
    if (is_updated_) shift_points();
    is_updated_ = false;
    Matrix<3> Fx = Matrix<3>::Identity();
    Fx.topRightCorner<2, 1>() = quarter_turned(to_vector(step.pose).head<2>() - n_x_);
    move_pose(step.pose, Fx, noise);
    n_x_ = mean_.head<2>();
  }

  void update(const StepContext& context, Scan scan) override {
    EkfSlam::update(context, scan);
    is_updated_ = true;
  }

 protected:
  /// Called before the first motion after a scan.
  virtual void shift_points() {}

  /// nu of the latest estimate, H at n_x and n_l; it does not depend on the heading.
  std::optional<LinearisedInnovation> linearised(std::size_t slot,
                                                 const Detection& z) const override {
    const auto latest = EkfSlam::linearised(slot, z);
    auto first = innovation_at({n_x_.x(), n_x_.y(), mean_(2)}, certain_landmark(n_l_[slot]), z, R_);
    if (!latest || !first) return std::nullopt;
    first->nu = latest->nu;
    return first;
  }

  /// Gx = [I, J a], a = theta - n_x (EQUATIONS (15.10)).
  Matrix23 derivative_by_pose(const LinearisedPlace<double>& placed) const override {
    Matrix23 Gx = Matrix23::Identity();
    Gx.col(2) = quarter_turned(to_vector(placed.point) - n_x_);
    return Gx;
  }

  void initialise(const Detection& z) override {
    EkfSlam::initialise(z);
    n_l_.emplace_back(mean_.tail<2>());
  }

  Vector<2> n_x_;               ///< point of the vehicle: the place as it was predicted
  std::vector<Vector<2>> n_l_;  ///< point of each landmark: as it was initialised

 private:
  bool is_updated_ = false;  ///< by a scan since the last motion
};

}  // namespace montecarta::filters::plain
