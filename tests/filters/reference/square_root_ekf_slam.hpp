// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"
#include "filters/joint/retraction.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <Eigen/Dense>

#include <algorithm>

namespace montecarta::filters::reference {

/// EKF-SLAM, or its right-invariant form, in a square root: the covariance is F F' with as many
/// columns as there were noises, made square again by QR at every detection. It is never formed,
/// nothing is subtracted from it, and no rounding can make it indefinite.
class SquareRootEkfSlam {
 public:
  SquareRootEkfSlam(const Belief& belief, Retraction retraction)
      : belief_(belief), retraction_(retraction) {}

  void start(const Pose& start) {
    mean.resize(3);
    mean << start.x, start.y, start.heading;
    F = Eigen::MatrixXd::Zero(3, 0);
  }

  Pose pose() const { return {mean(0), mean(1), mean(2)}; }

  void predict(const Control& control, double duration) {
    const auto step = linearised_move(pose(), control, duration, belief_.vehicle);
    mean.head<3>() << step.pose.x, step.pose.y, step.pose.heading;
    F.topRows<3>() = (pose_jacobian(step.jacobians) * F.topRows<3>()).eval();
    Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(F.rows(), 2);
    const Eigen::Vector2d sigma(belief_.control.sigma[0], belief_.control.sigma[1]);
    noise.topRows<3>() = control_jacobian(step.jacobians) * sigma.asDiagonal();
    append_columns(noise);
  }

  /// [sqrt(R) H F; 0 F] = [L 0; W F+] Q: the step is W L^-1 v.
  void update_with(Eigen::Index row, const RangeBearing<double>& detected) {
    const auto at = linearised_observation(pose(), Point{mean(row), mean(row + 1)});
    const Eigen::Index n = F.rows(), m = F.cols();
    Eigen::MatrixXd array = Eigen::MatrixXd::Zero(2 + n, 2 + m);
    array.topLeftCorner<2, 2>() = observation_noise();
    array.topRightCorner(2, m) =
        pose_jacobian(at) * F.topRows<3>() + landmark_jacobian(at) * F.middleRows<2>(row);
    array.bottomRightCorner(n, m) = F;
    const Eigen::MatrixXd lower = triangular(array);
    F = lower.bottomRightCorner(n, lower.cols() - 2);
    const Eigen::Vector2d white = lower.topLeftCorner<2, 2>().triangularView<Eigen::Lower>().solve(
        to_vector(residual(detected, at.observation)));
    move_by(lower.bottomLeftCorner(n, 2) * white);
  }

  void append(const RangeBearing<double>& observation) {
    const auto placed = linearised_place(pose(), observation);
    const Eigen::Index n = F.rows(), m = F.cols();
    F.conservativeResizeLike(Eigen::MatrixXd::Zero(n + 2, m));
    F.bottomRows<2>() = pose_jacobian(placed) * F.topRows<3>();
    Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(n + 2, 2);
    noise.bottomRows<2>() = observation_jacobian(placed) * observation_noise();
    append_columns(noise);
    mean.conservativeResize(n + 2);
    mean.tail<2>() = to_vector(placed.point);
  }

  Eigen::VectorXd mean;  ///< pose, then landmarks in order of initialisation
  Eigen::MatrixXd F;     ///< the covariance is F F'

 private:
  Eigen::Matrix2d observation_noise() const {
    return Eigen::Vector2d(belief_.sigma_range, belief_.sigma_bearing).asDiagonal();
  }

  void append_columns(const Eigen::MatrixXd& noise) {
    F.conservativeResize(Eigen::NoChange, F.cols() + noise.cols());
    F.rightCols(noise.cols()) = noise;
  }

  /// L with L L' = A A', lower triangular.
  static Eigen::MatrixXd triangular(const Eigen::MatrixXd& A) {
    const Eigen::MatrixXd transposed = A.transpose();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(transposed);
    const Eigen::Index n = std::min(A.rows(), A.cols());
    const Eigen::MatrixXd R = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
    return R.transpose();
  }

  /// Moves every point by its step, or by the group's; then the invariant error is carried along.
  void move_by(const Eigen::VectorXd& step) {
    const bool invariant = retraction_ == Retraction::invariant;
    const Eigen::Matrix2d V =
        invariant ? exponential_jacobian(step(2)) : Eigen::Matrix2d(Eigen::Matrix2d::Identity());
    const Eigen::RowVectorXd heading = F.row(2);
    for (Eigen::Index row = 0; row < mean.size(); row += row == 0 ? 3 : 2) {
      const Eigen::Vector2d moved = V * step.segment<2>(row);
      mean.segment<2>(row) += moved;
      if (invariant) F.middleRows<2>(row) += quarter_turn() * moved * heading;
    }
    mean(2) = wrap(mean(2) + step(2));
  }

  Belief belief_;
  Retraction retraction_;
};

}  // namespace montecarta::filters::reference
