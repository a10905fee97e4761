// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/plain/ekf_slam.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace montecarta::filters::plain {

/// Right-invariant EKF-SLAM (EQUATIONS 15; Barrau and Bonnabel 2015). It is EKF-SLAM with another
/// error, truth = exp(xi) mean, which turns and shifts pose and map together. P_ is the covariance
/// of xi.
class RiekfSlam final : public EkfSlam {
 public:
  using EkfSlam::EkfSlam;

  /// The prior is that of e = T xi, so that P_ = T^-1 P T^-T.
  void start_from(const StepContext& context, const Prior& prior) override {
    EkfSlam::start_from(context, prior);
    const Eigen::VectorXd Jp = quarter_turned_points();
    P_ -= (Jp * P_.row(2)).eval();
    P_ -= (P_.col(2) * Jp.transpose()).eval();
  }

  /// xi changes by the noise of the pose alone, of which B is its derivative; B Fu is the B of
  /// EQUATIONS (15.17).
  void predict(const StepContext& /*context*/, const Control& u, double duration) override {
    const auto step = linearised_move(pose(), u, duration, setup_.belief.vehicle);
    const ControlJacobian Fu = control_jacobian(step.jacobians);
    const Matrix<3> noise = Fu * control_noise(setup_.belief, u) * Fu.transpose() +
                            increment_covariance(setup_.belief, mean_(2), u, duration);
    mean_.head<3>() = to_vector(step.pose);
    Eigen::MatrixXd B = -quarter_turned_points() * Vector<3>::UnitZ().transpose();
    B.topRows<3>() += Matrix<3>::Identity();
    P_ += B * noise * B.transpose();
  }

  /// T P T' of e = T xi, e_p = xi_p + J p xi_heading for every point p (EQUATIONS (15.3)).
  Eigen::MatrixXd covariance() const override {
    const Eigen::VectorXd Jp = quarter_turned_points();
    const Eigen::MatrixXd TP = P_ + Jp * P_.row(2);
    return TP + TP.col(2) * Jp.transpose();
  }

 protected:
  /// A turn of pose and map changes no observation, so Hx = [-Hf 0] (EQUATIONS (15.18)).
  std::optional<LinearisedInnovation> linearised(std::size_t slot,
                                                 const Detection& z) const override {
    auto v = EkfSlam::linearised(slot, z);
    if (v) v->Hx << -v->Hf, Vector<2>::Zero();
    return v;
  }

  /// e_p = xi_p + J p xi_heading, so that H also has the turn about the origin.
  Matrix<2, Eigen::Dynamic> derivative_of_position() const override {
    Matrix<2, Eigen::Dynamic> H = EkfSlam::derivative_of_position();
    H.col(2) = quarter_turned(mean_.head<2>());
    return H;
  }

  /// mean <- exp(xi) mean: p <- R(a) p + V xi_p with a = xi_heading (EQUATIONS (15.18)). V of
  /// EQUATIONS (15.4) is the rotation by a / 2 times the ratio of a chord to its arc.
  void move_mean(const Eigen::VectorXd& xi) override {
    const double a = xi(2);
    const double chord = a == 0.0 ? 1.0 : std::sin(0.5 * a) / (0.5 * a);
    const Matrix<2> R = Eigen::Rotation2D<double>(a).toRotationMatrix();
    const Matrix<2> V = chord * Eigen::Rotation2D<double>(0.5 * a).toRotationMatrix();
    mean_(2) = wrap(mean_(2) + a);
    for_each_point([&](Eigen::Index row) {
      mean_.segment<2>(row) = (R * mean_.segment<2>(row) + V * xi.segment<2>(row)).eval();
    });
  }

  /// A new landmark turns with the vehicle: Gx = [I 0] (EQUATIONS (15.18)).
  Matrix23 derivative_by_pose(const LinearisedPlace<double>& /*placed*/) const override {
    return Matrix23::Identity();
  }

 private:
  /// Calls act(row) for the first row of the vehicle and of every landmark.
  template <class Act>
  void for_each_point(const Act& act) const {
    act(0);
    for (Eigen::Index row = 3; row < mean_.size(); row += 2) act(row);
  }
  /// J p of every point p, zero in the row of the heading.
  Eigen::VectorXd quarter_turned_points() const {
    Eigen::VectorXd turned = Eigen::VectorXd::Zero(mean_.size());
    for_each_point(
        [&](Eigen::Index row) { turned.segment<2>(row) = quarter_turned(mean_.segment<2>(row)); });
    return turned;
  }
};

}  // namespace montecarta::filters::plain
