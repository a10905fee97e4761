// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"
#include "experiments/judging/error_convention.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace montecarta::experiments {

inline StateShape plane_shape() {
  return {StateKind::pose, {"x_m", "y_m", "heading_rad"}, {"x", "y", "heading"}, {"m", "m", "rad"}};
}

inline StateShape space_shape() {
  return {StateKind::pose_in_space,
          {"x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"},
          {"x", "y", "z", "rx", "ry", "rz"},
          {"m", "m", "m", "rad", "rad", "rad"}};
}

/// exp(turn) and V(turn) by their series.
struct Exponential {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity(), V = Eigen::Matrix3d::Identity();

  explicit Exponential(const Eigen::Vector3d& turn) {
    const Eigen::Matrix3d cross{
        {0.0, -turn.z(), turn.y()}, {turn.z(), 0.0, -turn.x()}, {-turn.y(), turn.x(), 0.0}};
    Eigen::Matrix3d power = Eigen::Matrix3d::Identity();
    for (int k = 1; k < 30; ++k) {
      power = power * cross / k;
      R += power;
      V += power / (k + 1);
    }
  }
};

/// The mean whose error from `truth`, by a convention, is `error`: written down from the
/// convention's definition, apart from the code under test.
inline Eigen::VectorXd mean_with_error(const StateShape& shape, ErrorConvention convention,
                                       const Eigen::VectorXd& truth, const Eigen::VectorXd& error) {
  const bool plane = shape.kind == StateKind::pose;
  Eigen::Vector3d p, rho, turn;
  Eigen::Matrix3d R;
  if (plane) {
    p << truth(0), truth(1), 0.0;
    rho << error(0), error(1), 0.0;
    turn << 0.0, 0.0, error(2);
    R = Eigen::AngleAxisd(truth(2), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  } else {
    p = truth.head<3>();
    rho = error.head<3>();
    turn = error.tail<3>();
    R = Eigen::Quaterniond(Eigen::Vector4d(truth.tail<4>())).toRotationMatrix();
  }
  const Exponential exponential(turn);
  const bool is_body = convention == ErrorConvention::body;
  const Eigen::Matrix3d turned = is_body ? R * exponential.R : exponential.R * R;
  if (convention == ErrorConvention::world) p += rho;
  if (is_body) p += turned * rho;
  if (convention == ErrorConvention::right_invariant) p = exponential.R * p + exponential.V * rho;
  Eigen::VectorXd mean(shape.width());
  if (plane) {
    mean << p.x(), p.y(), wrap(truth(2) + error(2));
  } else {
    mean << p, Eigen::Quaterniond(turned).normalized().coeffs();
  }
  return mean;
}

/// A state some ten metres from the origin.
inline Eigen::VectorXd drawn_truth(const StateShape& shape, RngStream& draw) {
  Eigen::VectorXd truth(shape.width());
  for (auto& value : truth) value = 10.0 * draw.normal();
  if (shape.kind == StateKind::pose) truth(2) = wrap(truth(2));
  if (shape.kind == StateKind::pose_in_space) truth.tail<4>().normalize();
  return truth;
}

/// Deviations of 0.3 m and 0.1 rad that differ from component to component, correlated.
inline Eigen::MatrixXd some_covariance(const StateShape& shape) {
  const auto d = static_cast<Eigen::Index>(shape.dimension());
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(d, d);
  for (Eigen::Index i = 0; i < d; ++i) {
    const double deviation = shape.units[static_cast<std::size_t>(i)] == "rad" ? 0.1 : 0.3;
    L(i, i) = deviation * (i % 2 == 0 ? 1.0 : 0.2);
    for (Eigen::Index j = 0; j < i; ++j) L(i, j) = 0.3 * deviation * (i + j == 2 ? -0.5 : 0.2);
  }
  return L * L.transpose();
}

inline Eigen::VectorXd drawn_error(const Eigen::MatrixXd& covariance, RngStream& draw) {
  Eigen::VectorXd normal(covariance.rows());
  for (auto& value : normal) value = draw.normal();
  return covariance.llt().matrixL() * normal;
}

}  // namespace montecarta::experiments
