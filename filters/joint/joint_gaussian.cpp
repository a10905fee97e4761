// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"

#include "filters/joint/packs.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta {
namespace {

Eigen::Matrix2d sight_noise(const Belief& belief) {
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
  const Eigen::Index held = map_.rows();
  const Eigen::Index wanted = packed(room);
  map_mean_.conservativeResize(wanted);
  cross_.conservativeResize(wanted, 3);
  map_.conservativeResize(wanted, wanted);
  seen_.resize(wanted, 2);
  gain_map_.resize(wanted, 4);
  map_step_.resize(2, wanted / 2);
  map_mean_.tail(wanted - held).setZero();
  cross_.bottomRows(wanted - held).setZero();
  map_.bottomRows(wanted - held).setZero();
  map_.rightCols(wanted - held).setZero();
}

Eigen::Index JointGaussian::rows() const { return packed(n_landmarks_); }

void JointGaussian::start(const Pose& start) {
  pose_ = {start, Eigen::Matrix3d::Zero()};
  n_landmarks_ = 0;
  map_mean_.setZero();
  cross_.setZero();
  map_.setZero();
}

void JointGaussian::become(const JointGaussian& other) {
  if (map_.rows() < other.rows()) grow(other.n_landmarks_);
  const Eigen::Index here = rows(), there = other.rows();
  map_mean_.head(here).setZero();  // what lies behind the last landmark is zero
  cross_.topRows(here).setZero();
  map_.topLeftCorner(here, here).setZero();
  pose_ = other.pose_;
  n_landmarks_ = other.n_landmarks_;
  map_mean_.head(there) = other.map_mean_.head(there);
  cross_.topRows(there) = other.cross_.topRows(there);
  map_.topLeftCorner(there, there) = other.map_.topLeftCorner(there, there);
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
  cross_.col(0).head(rows()) -= way.y * cross_.col(2).head(rows());
  cross_.col(1).head(rows()) += way.x * cross_.col(2).head(rows());
  pose_ = pose_after(motion);
}

LandmarkEstimate JointGaussian::landmark(std::size_t slot) const {
  const Eigen::Index at = row_of(slot);
  return {map_mean_.segment<2>(at), map_.block<2, 2>(at, at)};
}

JointEstimate JointGaussian::joint() const {
  const Eigen::Index map = row_of(n_landmarks_);
  JointEstimate joint{Eigen::VectorXd(3 + map), Eigen::MatrixXd(3 + map, 3 + map)};
  joint.mean << pose_.mean.x, pose_.mean.y, pose_.mean.heading, map_mean_.head(map);
  joint.covariance.topLeftCorner<3, 3>() = pose_.covariance;
  joint.covariance.bottomLeftCorner(map, 3) = cross_.topRows(map);
  joint.covariance.topRightCorner(3, map) = cross_.topRows(map).transpose();
  joint.covariance.bottomRightCorner(map, map) =
      map_.topLeftCorner(map, map).selfadjointView<Eigen::Lower>();
  return joint;
}

double JointGaussian::extent() const {
  double farthest_squared = 0.0;
  for (Eigen::Index row = 0; row < row_of(n_landmarks_); row += 2) {
    const double x = map_mean_(row) - pose_.mean.x, y = map_mean_(row + 1) - pose_.mean.y;
    farthest_squared = std::max(farthest_squared, x * x + y * y);
  }
  return std::sqrt(farthest_squared);
}

std::optional<InnovationFactor> JointGaussian::innovation_factor(std::size_t slot,
                                                                 const ExpectedSight& at) const {
  const Eigen::Index row = row_of(slot);
  const Matrix23& Hx = at.pose_jacobian;
  const Eigen::Matrix2d& Hf = at.landmark_jacobian;
  const Eigen::Matrix2d mixed = Hf * cross_.middleRows<2>(row) * Hx.transpose();
  return factor(Hx * pose_.covariance * Hx.transpose() + mixed + mixed.transpose() +
                Hf * map_.block<2, 2>(row, row) * Hf.transpose() + sight_noise(belief_));
}

JointGaussian::Trouble JointGaussian::look_at(std::size_t slot, ExpectedSight& expected) const {
  const Eigen::Index row = row_of(slot);
  const auto at = linearised_sight(pose_.mean, Point{map_mean_(row), map_mean_(row + 1)});
  if (too_near(at.sight)) return Trouble::too_near;
  expected = {.pose_jacobian = pose_jacobian(at),
              .landmark_jacobian = landmark_jacobian(at),
              .sight = at.sight,
              .factor = {},
              .ahead = Eigen::Vector2d::Zero()};
  const auto L = innovation_factor(slot, expected);
  if (!L) return Trouble::faulty;
  expected.factor = *L;
  return Trouble::none;
}

void JointGaussian::append(const RangeBearing<double>& sight) {
  if (packed(n_landmarks_ + 1) > map_.rows()) grow(std::max<std::size_t>(8, 2 * n_landmarks_));
  const auto placed = linearised_place(pose_.mean, sight);
  const Matrix23 Gx = pose_jacobian(placed);
  const Eigen::Matrix2d Gz = sight_jacobian(placed);
  const Eigen::Index row = row_of(n_landmarks_);
  map_mean_.segment<2>(row) = to_vector(placed.point);
  map_.block(row, 0, 2, row).noalias() = Gx.lazyProduct(cross_.topRows(row).transpose());
  mirror_pack(map_, row);
  cross_.middleRows<2>(row) = Gx * pose_.covariance;
  Eigen::Matrix2d birth =
      Gx * pose_.covariance * Gx.transpose() + Gz * sight_noise(belief_) * Gz.transpose();
  birth(0, 1) = birth(1, 0);
  map_.block<2, 2>(row, row) = birth;
  ++n_landmarks_;
}

}  // namespace montecarta
