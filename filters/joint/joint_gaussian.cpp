// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::filters {
namespace {

Eigen::Matrix2d observation_noise(const Belief& belief) {
  return Eigen::Vector2d(belief.sigma_range * belief.sigma_range,
                         belief.sigma_bearing * belief.sigma_bearing)
      .asDiagonal();
}

/// How a motion moves a vehicle that heads along `heading`, in the map frame.
Point way_of(const MotionIncrement& motion, const Direction<double>& heading) {
  return in_world(heading, motion.pose().x, motion.pose().y);
}

}  // namespace

JointGaussian::JointGaussian(const Belief& belief, Retraction retraction, std::size_t room)
    : belief_(belief), retraction_(retraction) {
  grow(room);
}

void JointGaussian::grow(std::size_t room) {
  const Eigen::Index wanted = packed(room);
  map_.make_room(wanted);
  seen_.resize(wanted, 2);
  gain_map_.resize(wanted, 4);
  map_step_.resize(2, wanted / 2);
}

Eigen::Index JointGaussian::rows() const { return packed(n_landmarks_); }

void JointGaussian::start(const Pose& start) {
  pose_ = {start, Eigen::Matrix3d::Zero()};
  map_.clear(rows());
  n_landmarks_ = 0;
}

void JointGaussian::become(const JointGaussian& other) {
  pose_ = other.pose_;
  replace_map(other.n_landmarks_).take(other.map_, other.rows());
}

MapMoments& JointGaussian::replace_map(std::size_t n_points) {
  map_.clear(rows());
  if (map_.room() < packed(n_points)) grow(n_points);
  n_landmarks_ = n_points;
  return map_;
}

PoseMoments JointGaussian::pose_after(const MotionIncrement& motion) const {
  const Direction<double> heading = direction_of(pose_.mean.heading);
  const Point way = way_of(motion, heading);
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity(), turn = Eigen::Matrix3d::Identity();
  F(0, 2) = -way.y;
  F(1, 2) = way.x;
  turn.topLeftCorner<2, 2>() << heading.cosine, -heading.sine, heading.sine, heading.cosine;
  PoseMoments moved;
  moved.mean = {pose_.mean.x + way.x, pose_.mean.y + way.y,
                wrap(pose_.mean.heading + motion.pose().heading)};
  moved.covariance = F * pose_.covariance * F.transpose() +
                     turn * symmetric(motion.covariance()) * turn.transpose();
  mirror_lower(moved.covariance);
  return moved;
}

void JointGaussian::move(const MotionIncrement& motion) {
  const Point way = way_of(motion, direction_of(pose_.mean.heading));
  map_.cross.col(0).head(rows()) -= way.y * map_.cross.col(2).head(rows());
  map_.cross.col(1).head(rows()) += way.x * map_.cross.col(2).head(rows());
  pose_ = pose_after(motion);
}

LandmarkEstimate JointGaussian::landmark(std::size_t slot) const {
  const Eigen::Index at = row_of(slot);
  return {map_.mean.segment<2>(at), map_.covariance.block<2, 2>(at, at)};
}

PointMoments JointGaussian::point(std::size_t slot) const {
  const Eigen::Index at = row_of(slot);
  return {map_.mean.segment<2>(at), map_.cross.middleRows<2>(at),
          map_.covariance.block<2, 2>(at, at)};
}

std::optional<InnovationFactor> JointGaussian::innovation_factor(
    const PointMoments& landmark, const ExpectedObservation& at) const {
  const Matrix23& Hx = at.pose_jacobian;
  const Eigen::Matrix2d& Hf = at.landmark_jacobian;
  const Eigen::Matrix2d mixed = Hf * landmark.cross * Hx.transpose();
  return factor(Hx * pose_.covariance * Hx.transpose() + mixed + mixed.transpose() +
                Hf * landmark.covariance * Hf.transpose() + observation_noise(belief_));
}

JointGaussian::Trouble JointGaussian::look_at(const PointMoments& landmark,
                                              ExpectedObservation& expected) const {
  const auto at = linearised_observation(pose_.mean, Point{landmark.mean.x(), landmark.mean.y()});
  if (too_near(at.observation)) return Trouble::too_near;
  expected = {.pose_jacobian = pose_jacobian(at),
              .landmark_jacobian = landmark_jacobian(at),
              .observation = at.observation,
              .factor = {},
              .ahead = Eigen::Vector2d::Zero()};
  const auto L = innovation_factor(landmark, expected);
  if (!L) return Trouble::faulty;
  expected.factor = *L;
  return Trouble::none;
}

void JointGaussian::append(const RangeBearing<double>& observation) {
  if (packed(n_landmarks_ + 1) > map_.room()) grow(std::max<std::size_t>(8, 2 * n_landmarks_));
  const auto placed = linearised_place(pose_.mean, observation);
  const Matrix23 Gx = pose_jacobian(placed);
  const Eigen::Matrix2d Gz = observation_jacobian(placed);
  const Eigen::Index row = row_of(n_landmarks_);
  map_.mean.segment<2>(row) = to_vector(placed.point);
  map_.covariance.block(row, 0, 2, row).noalias() =
      Gx.lazyProduct(map_.cross.topRows(row).transpose());
  mirror_pack(map_.covariance, row);
  map_.cross.middleRows<2>(row) = Gx * pose_.covariance;
  Eigen::Matrix2d covariance =
      Gx * pose_.covariance * Gx.transpose() + Gz * observation_noise(belief_) * Gz.transpose();
  covariance(0, 1) = covariance(1, 0);
  map_.covariance.block<2, 2>(row, row) = covariance;
  ++n_landmarks_;
}

}  // namespace montecarta::filters
