// SPDX-License-Identifier: BSD-3-Clause
#include "filters/ekf_slam/joint_gaussian.hpp"

#include "engine/errors.hpp"
#include "filters/models/eigen_jacobians.hpp"

#include <algorithm>

namespace montecarta {
namespace {

constexpr Eigen::Index kPacket =
    8;  ///< rows are stored in packs of eight; those behind the last landmark are 0

Eigen::Index packed(std::size_t n_landmarks) {
  return (2 * static_cast<Eigen::Index>(n_landmarks) + kPacket - 1) / kPacket * kPacket;
}

Eigen::Index row_of(std::size_t slot) { return 2 * static_cast<Eigen::Index>(slot); }

void mirror_lower(Eigen::Matrix3d& P) { P.triangularView<Eigen::StrictlyUpper>() = P.transpose(); }

Eigen::Matrix2d sight_noise(const Belief& belief) {
  return Eigen::Vector2d(belief.sigma_range * belief.sigma_range,
                         belief.sigma_bearing * belief.sigma_bearing)
      .asDiagonal();
}

/// P' = Fx P Fx' + Fu Q Fu'.
Eigen::Matrix3d moved_covariance(const Eigen::Matrix3d& P, const MotionJacobians<double>& j,
                                 const Belief& belief) {
  const Eigen::Vector2d sigma(belief.sigma_speed, belief.sigma_steer);
  const Matrix32 noise = control_jacobian(j) * sigma.asDiagonal();
  Eigen::Matrix3d F_P = P;
  F_P.row(0) += j.x_heading * P.row(2);
  F_P.row(1) += j.y_heading * P.row(2);
  Eigen::Matrix3d moved = F_P;
  moved.col(0) += j.x_heading * F_P.col(2);
  moved.col(1) += j.y_heading * F_P.col(2);
  moved += noise * noise.transpose();
  mirror_lower(moved);
  return moved;
}

}  // namespace

JointGaussian::JointGaussian(const Belief& belief, Retraction retraction, std::size_t room)
    : belief_(belief), retraction_(retraction) {
  grow(room);
}

void JointGaussian::grow(std::size_t room) {
  const Eigen::Index held = map_.rows();
  const Eigen::Index wanted = packed(room);
  map_mean_.conservativeResize(wanted);
  cross_.conservativeResize(wanted, 3);
  map_.conservativeResize(wanted, wanted);
  gain_map_.resize(wanted, 2);
  map_step_.resize(2, wanted / 2);
  map_mean_.tail(wanted - held).setZero();
  cross_.bottomRows(wanted - held).setZero();
  map_.bottomRows(wanted - held).setZero();
  map_.rightCols(wanted - held).setZero();
}

Eigen::Index JointGaussian::rows() const { return packed(n_landmarks_); }

void JointGaussian::start(const Pose& start) {
  pose_ = {start, Eigen::Matrix3d::Zero()};
  pending_x_heading_ = pending_y_heading_ = 0.0;
  n_landmarks_ = 0;
  map_mean_.setZero();
  cross_.setZero();
  map_.setZero();
}

void JointGaussian::move(const Control& control, double duration) {
  const auto step = linearised_move(pose_.mean, control, duration, belief_.vehicle);
  pose_.mean = step.pose;
  pose_.covariance = moved_covariance(pose_.covariance, step.jacobians, belief_);
  pending_x_heading_ += step.jacobians.x_heading;
  pending_y_heading_ += step.jacobians.y_heading;
}

void JointGaussian::finish_motion() {
  cross_.col(0).head(rows()) += pending_x_heading_ * cross_.col(2).head(rows());
  cross_.col(1).head(rows()) += pending_y_heading_ * cross_.col(2).head(rows());
  pending_x_heading_ = pending_y_heading_ = 0.0;
}

LandmarkEstimate JointGaussian::landmark(std::size_t slot) const {
  const Eigen::Index at = row_of(slot);
  return {map_mean_.segment<2>(at), map_.block<2, 2>(at, at)};
}

Eigen::Matrix2d JointGaussian::innovation_covariance(std::size_t slot,
                                                     const LinearisedSight<double>& at) const {
  const Eigen::Index row = row_of(slot);
  const Matrix23 Hx = pose_jacobian(at);
  const Eigen::Matrix2d Hf = landmark_jacobian(at);
  const Eigen::Matrix2d mixed = Hf * cross_.middleRows<2>(row) * Hx.transpose();
  return Hx * pose_.covariance * Hx.transpose() + mixed + mixed.transpose() +
         Hf * map_.block<2, 2>(row, row) * Hf.transpose() + sight_noise(belief_);
}

JointGaussian::Trouble JointGaussian::look_at(std::size_t slot, ExpectedSight& expected) const {
  const Eigen::Index row = row_of(slot);
  expected.sight = linearised_sight(pose_.mean, Point{map_mean_(row), map_mean_(row + 1)});
  if (too_near(expected.sight.sight)) return Trouble::too_near;
  const auto L = factor(innovation_covariance(slot, expected.sight));
  if (!L) return Trouble::faulty;
  expected.innovation = *L;
  return Trouble::none;
}

void JointGaussian::whiten_gain(std::size_t slot, const ExpectedSight& expected) {
  const Matrix23 Hx = pose_jacobian(expected.sight);
  const Eigen::Matrix2d Hf = landmark_jacobian(expected.sight);
  const InnovationFactor& L = expected.innovation;
  Eigen::Matrix2d
      inverse_Lt;  // of the triangular factor, two divisions; S itself is never inverted
  inverse_Lt << 1.0 / L.l00, -L.l10 / (L.l00 * L.l11), 0.0, 1.0 / L.l11;
  const Matrix32 Hx_white = Hx.transpose() * inverse_Lt;
  const Eigen::Matrix2d Hf_white = Hf.transpose() * inverse_Lt;
  const Eigen::Index row = row_of(slot);
  gain_pose_ = pose_.covariance * Hx_white + cross_.middleRows<2>(row).transpose() * Hf_white;
  gain_map_.topRows(rows()).noalias() = cross_.topRows(rows()).lazyProduct(Hx_white);
  gain_map_.topRows(rows()).noalias() += map_.block(0, row, rows(), 2).lazyProduct(Hf_white);
}

/// P <- P - K S K' = P - W W' with W = P H' L^-T. Whole packs in one order: exactly symmetric.
void JointGaussian::subtract_information() {
  const auto first = gain_map_.col(0).head(rows());
  const auto second = gain_map_.col(1).head(rows());
  pose_.covariance -= gain_pose_ * gain_pose_.transpose();
  mirror_lower(pose_.covariance);
  for (Eigen::Index j = 0; j < 3; ++j) {
    cross_.col(j).head(rows()) -= first * gain_pose_(j, 0) + second * gain_pose_(j, 1);
  }
  for (Eigen::Index j = 0; j < row_of(n_landmarks_); ++j) {
    map_.col(j).head(rows()) -= first * gain_map_(j, 0) + second * gain_map_(j, 1);
  }
}

double JointGaussian::absorb(std::size_t slot, const ExpectedSight& expected,
                             const Eigen::Vector2d& innovation) {
  const Eigen::Vector2d white = expected.innovation.whiten(innovation);
  whiten_gain(slot, expected);
  subtract_information();
  step(white);
  return white.squaredNorm();
}

void JointGaussian::step(const Eigen::Vector2d& white) {
  const Eigen::Vector3d pose_step = gain_pose_ * white;
  Eigen::Vector2d moved = pose_step.head<2>();
  auto map_step = map_step_.reshaped().head(rows());
  map_step = gain_map_.topRows(rows()).lazyProduct(white);
  if (retraction_ == Retraction::invariant) {
    const Eigen::Matrix2d V = exponential_jacobian(pose_step(2));
    moved = V * moved;
    apply(V, map_step_.leftCols(rows() / 2));
  }
  pose_.mean = {pose_.mean.x + moved(0), pose_.mean.y + moved(1),
                wrap(pose_.mean.heading + pose_step(2))};
  map_mean_.head(rows()) += map_step;
  if (retraction_ == Retraction::invariant) transport(moved);
}

void JointGaussian::append(const RangeBearing<double>& sight) {
  if (packed(n_landmarks_ + 1) > map_.rows()) grow(std::max<std::size_t>(8, 2 * n_landmarks_));
  const auto placed = linearised_place(pose_.mean, sight);
  const Matrix23 Gx = pose_jacobian(placed);
  const Eigen::Matrix2d Gz = sight_jacobian(placed);
  const Eigen::Index row = row_of(n_landmarks_);
  map_mean_.segment<2>(row) = to_vector(placed.point);
  map_.block(0, row, row, 2).noalias() = cross_.topRows(row).lazyProduct(Gx.transpose());
  map_.block(row, 0, 2, row) = map_.block(0, row, row, 2).transpose();
  cross_.middleRows<2>(row) = Gx * pose_.covariance;
  Eigen::Matrix2d birth =
      Gx * pose_.covariance * Gx.transpose() + Gz * sight_noise(belief_) * Gz.transpose();
  birth(0, 1) = birth(1, 0);
  map_.block<2, 2>(row, row) = birth;
  ++n_landmarks_;
}

}  // namespace montecarta
