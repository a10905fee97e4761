// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_gaussian.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::filters {
namespace {

Eigen::Matrix2d observation_noise(const Belief& belief) {
  return deviations_of(belief.sensor, belief).cwiseAbs2().asDiagonal();
}

/// How a motion moves a vehicle that heads along `heading`, in the map frame.
Point way_of(const MotionIncrement& motion, const Direction<double>& heading) {
  return in_world(heading, motion.pose().x, motion.pose().y);
}

}  // namespace

JointGaussian::JointGaussian(const Belief& belief, Retraction retraction, std::size_t room)
    : belief_(belief),
      observation_noise_(observation_noise(belief)),
      wraps_(wraps_of(belief.sensor)),
      retraction_(retraction) {
  grow(room);
}

void JointGaussian::grow(std::size_t room) {
  const Eigen::Index wanted = packed(room);
  map_.make_room(wanted);
  seen_.resize(wanted, 2);
  gain_map_.resize(wanted, 4);
  moved_.resize(wanted, 3);
  halved_.resize(wanted, 3);
  map_step_.resize(2, wanted / 2);
}

void JointGaussian::start(const Pose& start) {
  pose_ = {start, Eigen::Matrix3d::Zero()};
  map_.clear(rows());
  n_landmarks_ = 0;
}

void JointGaussian::replace(const PoseMoments& pose, const MapMoments& map) {
  pose_ = pose;
  map_.take(map, rows());
}

MapMoments& JointGaussian::replace_map(std::size_t n_points) {
  map_.clear(rows());
  if (map_.room() < packed(n_points)) grow(n_points);
  n_landmarks_ = n_points;
  return map_;
}

LinearisedMotion JointGaussian::linearised(const MotionIncrement& motion) const {
  const Direction<double> heading = direction_of(pose_.mean.heading);
  const Point way = way_of(motion, heading);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << heading.cosine, -heading.sine, heading.sine, heading.cosine;
  return {.mean = {pose_.mean.x + way.x, pose_.mean.y + way.y,
                   wrap(pose_.mean.heading + motion.pose().heading)},
          .by_heading = {-way.y, way.x},
          .noise = turn * symmetric(motion.covariance()) * turn.transpose()};
}

PoseMoments JointGaussian::pose_after(const LinearisedMotion& motion) const {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F.topRightCorner<2, 1>() = motion.by_heading;
  PoseMoments moved{motion.mean, F * pose_.covariance * F.transpose() + motion.noise};
  mirror_lower(moved.covariance);
  return moved;
}

/// Asked at every control: in one piece.
[[gnu::flatten]] PoseMoments JointGaussian::pose_after(const MotionIncrement& motion) const {
  return pose_after(linearised(motion));
}

void JointGaussian::move(const LinearisedMotion& motion) {
  map_.cross.col(0).head(rows()) += motion.by_heading(0) * map_.cross.col(2).head(rows());
  map_.cross.col(1).head(rows()) += motion.by_heading(1) * map_.cross.col(2).head(rows());
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

JointGaussian::Trouble JointGaussian::weigh(const PointMoments& landmark,
                                            const Eigen::Matrix2d& more,
                                            ExpectedObservation& expected) const {
  const Matrix23& Hx = expected.pose_jacobian;
  const Eigen::Matrix2d& Hf = expected.landmark_jacobian;
  const Eigen::Matrix2d mixed = Hf * landmark.cross * Hx.transpose();
  const auto L = factor(Hx * pose_.covariance * Hx.transpose() + mixed + mixed.transpose() +
                        Hf * landmark.covariance * Hf.transpose() + more + observation_noise_);
  if (!L) return Trouble::faulty;
  expected.factor = *L;
  return Trouble::none;
}

JointGaussian::Trouble JointGaussian::look_at(const PointMoments& landmark,
                                              ExpectedObservation& expected,
                                              const std::optional<ObservationPoint>& at) const {
  const auto linearised = [&](const Pose& pose, const Eigen::Vector2d& point) {
    return linearised_detection(belief_.sensor, pose, Point{point.x(), point.y()});
  };
  auto seen = linearised(pose_.mean, landmark.mean);
  if (!seen) return Trouble::too_near;
  expected.observation = seen->value;
  if (at && !(seen = linearised(at->pose, at->landmark))) return Trouble::too_near;
  expected.pose_jacobian = seen->by_pose;
  expected.landmark_jacobian = seen->by_landmark;
  expected.ahead.setZero();
  expected.wraps = wraps_;
  return weigh(landmark, Eigen::Matrix2d::Zero(), expected);
}

void JointGaussian::append(const Eigen::Vector2d& detection, const Eigen::Vector2d& behind) {
  auto placed = placed_landmark(belief_.sensor, pose_.mean, detection);
  expect(placed.has_value(), "a landmark is placed by a detection that does not fix it");
  const Eigen::Matrix2d& Gz = placed->by_detection;
  placed->by_pose.col(2) += quarter_turned(behind);
  append(NewPoint{.mean = placed->point,
                  .by_pose = placed->by_pose,
                  .noise = Gz * observation_noise_ * Gz.transpose()});
}

void JointGaussian::append(const NewPoint& point) {
  if (packed(n_landmarks_ + 1) > map_.room()) grow(std::max<std::size_t>(8, 2 * n_landmarks_));
  put(row_of(n_landmarks_), point);
  ++n_landmarks_;
}

void JointGaussian::replace(std::size_t slot, const NewPoint& point) {
  put(row_of(slot), point);
  mirror_packs(map_.covariance, rows());
}

/// Linear in what it is made of, so its covariances are sums of theirs. Rows of `seen_`: with the
/// points that there are.
void JointGaussian::put(Eigen::Index row, const NewPoint& point) {
  const Matrix23& Gx = point.by_pose;
  auto columns = seen_.topRows(rows());
  columns.noalias() = map_.cross.topRows(rows()).lazyProduct(Gx.transpose());
  Matrix23 cross = Gx * pose_.covariance;
  for (const auto& [slot, G] : point.by_points) {
    auto part = gain_map_.leftCols<2>().topRows(rows());
    copy_columns(map_.covariance, row_of(slot), rows(), part);
    columns.noalias() += part.lazyProduct(G.transpose());
    cross += G * map_.cross.middleRows<2>(row_of(slot));
  }
  Eigen::Matrix2d covariance = cross * Gx.transpose() + point.noise;
  for (const auto& [slot, G] : point.by_points) {
    covariance += seen_.middleRows<2>(row_of(slot)).transpose() * G.transpose();
  }
  covariance(0, 1) = covariance(1, 0);
  map_.mean.segment<2>(row) = point.mean;
  map_.cross.middleRows<2>(row) = cross;
  if (row < row_of(n_landmarks_)) {
    write_columns(map_.covariance, row, rows(), columns);
  } else {
    map_.covariance.block(row, 0, 2, row) = columns.topRows(row).transpose();
  }
  mirror_pack(map_.covariance, row);
  map_.covariance.block<2, 2>(row, row) = covariance;
}

Matrix7 JointGaussian::covariance_with(std::size_t first, std::size_t second) const {
  const Eigen::Index a = row_of(first), b = row_of(second);
  Matrix7 P;
  P.topLeftCorner<3, 3>() = pose_.covariance;
  P.block<2, 3>(3, 0) = map_.cross.middleRows<2>(a);
  P.block<2, 3>(5, 0) = map_.cross.middleRows<2>(b);
  P.block<2, 2>(3, 3) = map_.covariance.block<2, 2>(a, a);
  P.block<2, 2>(5, 3) = covariance_of(map_.covariance, b, a);
  P.block<2, 2>(5, 5) = map_.covariance.block<2, 2>(b, b);
  P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
  return P;
}

}  // namespace montecarta::filters
