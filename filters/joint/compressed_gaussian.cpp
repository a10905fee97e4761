// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/compressed_gaussian.hpp"

#include "filters/joint/products.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace montecarta::filters {
namespace {

/// Up to so many landmarks a map has no far ones: below, expanding costs more than is saved.
constexpr std::size_t kSmallMap = 100;

double distance_squared(const Pose& pose, const Eigen::Vector2d& place) {
  return (place - place_of(pose)).squaredNorm();
}

}  // namespace

CompressedGaussian::CompressedGaussian(const Belief& belief, Retraction retraction,
                                       std::size_t room)
    : near_(belief, retraction, std::min(room, kSmallMap)),
      retraction_(retraction),
      most_near_(kSmallMap) {}

void CompressedGaussian::start(const Pose& start) {
  near_.start(start);
  whole_.clear(std::min(rows(), whole_.room()));
  basis_.clear();
  stand_ins_ = 0;
  point_of_.clear();
  most_near_ = kSmallMap;
  updates_ = 0;
  balance_ = 0.0;
  rests_ = false;
}

void CompressedGaussian::replace(const PoseMoments& pose, const MapMoments& map) {
  near_.replace_map(landmarks());
  near_.replace(pose, map);
  std::iota(point_of_.begin(), point_of_.end(), 0U);
  whole_.clear(std::min(rows(), whole_.room()));
  basis_.clear();
  stand_ins_ = 0;
  most_near_ = kSmallMap;
  updates_ = 0;
}

void CompressedGaussian::centre_on_pose() {
  if (std::ranges::find(point_of_, kFar) != point_of_.end()) replace(pose(), map());
  near_.centre_on_pose();
}

Eigen::Vector2d CompressedGaussian::mean_of(std::size_t slot) const {
  if (is_near(slot)) return near_.map().mean.segment<2>(row_of(point_of_[slot]));
  const Eigen::Index row = row_of(slot);
  return whole_.mean.segment<2>(row) + basis_.vectors().middleRows<2>(row) * coefficients_of_mean();
}

PointMoments CompressedGaussian::far_point(std::size_t slot) const {
  const Eigen::Index row = row_of(slot);
  const auto W = basis_.vectors().middleRows<2>(row);
  Columns2 YW(basis_.size(), 2);
  for (Eigen::Index j = 0; j < 2; ++j) {
    YW.col(j).noalias() = coefficients_of_covariance() * W.row(j).transpose();
  }
  PointMoments point{.mean = mean_of(slot),
                     .cross = W * coefficients_of_cross(),
                     .covariance = whole_.covariance.block<2, 2>(row, row) + W * YW};
  point.covariance(0, 1) = point.covariance(1, 0);
  return point;
}

PointMoments CompressedGaussian::point(std::size_t slot) const {
  return is_near(slot) ? near_.point(point_of_[slot]) : far_point(slot);
}

LandmarkEstimate CompressedGaussian::landmark(std::size_t slot) const {
  const PointMoments moments = point(slot);
  return {moments.mean, moments.covariance};
}

MapMoments CompressedGaussian::map() const {
  MapMoments map = whole_;
  map.make_room(rows());
  expand_into(map);
  return map;
}

JointEstimate CompressedGaussian::joint() const {
  const MapMoments whole = map();
  const Eigen::Index n = row_of(landmarks());
  JointEstimate joint{Eigen::VectorXd(3 + n), Eigen::MatrixXd(3 + n, 3 + n)};
  joint.mean << pose().mean.x, pose().mean.y, pose().mean.heading, whole.mean.head(n);
  joint.covariance.topLeftCorner<3, 3>() = pose().covariance;
  joint.covariance.bottomLeftCorner(n, 3) = whole.cross.topRows(n);
  joint.covariance.topRightCorner(3, n) = whole.cross.topRows(n).transpose();
  joint.covariance.bottomRightCorner(n, n) =
      whole.covariance.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
  return joint;
}

CompressedGaussian::Drift CompressedGaussian::drift() const {
  const Eigen::MatrixXd Y = coefficients_of_covariance();
  return {coefficients_of_mean().norm(), std::sqrt(dot(Y.reshaped(), Y.reshaped()))};
}

/// The range alone decides: v^2 / S of it is no more than D^2, and the standard deviation of a
/// difference no more than the sum of both.
bool CompressedGaussian::is_out_of_reach(std::size_t slot, const Drift& drift, double range,
                                         double sigmas) const {
  if (is_near(slot)) return false;
  const auto& [share, variance] = far_[slot];
  const double distance =
      std::sqrt(distance_squared(pose().mean, whole_.mean.segment<2>(row_of(slot))));
  const double spread = std::sqrt(variance + share * share * drift.variance) +
                        std::sqrt(pose().covariance.topLeftCorner<2, 2>().trace());
  const Belief& belief = near_.belief();
  const double noise = length_deviation(belief.sensor, belief, range);
  return distance - share * drift.mean - range > sigmas * (spread + noise);
}

JointGaussian::Trouble CompressedGaussian::look_at(
    std::size_t slot, ExpectedObservation& expected,
    const std::optional<ObservationPoint>& at) const {
  return near_.look_at(point(slot), expected, at);
}

void CompressedGaussian::append(const Eigen::Vector2d& detection, const Eigen::Vector2d& behind) {
  point_of_.push_back(static_cast<std::uint32_t>(near_.landmarks()));
  near_.append(detection, behind);
}

void CompressedGaussian::use_near_slots(NewPoint& point) const {
  for (NewPoint::Part& part : point.by_points) {
    assert(is_near(part.slot));
    part.slot = point_of_[part.slot];
  }
}

void CompressedGaussian::append(NewPoint point) {
  use_near_slots(point);
  point_of_.push_back(static_cast<std::uint32_t>(near_.landmarks()));
  near_.append(point);
}

void CompressedGaussian::replace(std::size_t slot, NewPoint point) {
  assert(is_near(slot));
  use_near_slots(point);
  near_.replace(point_of_[slot], point);
}

Matrix7 CompressedGaussian::covariance_with(std::size_t first, std::size_t second) const {
  assert(is_near(first) && is_near(second));
  return near_.covariance_with(point_of_[first], point_of_[second]);
}

void CompressedGaussian::make_near(std::span<const std::uint32_t> slots) {
  const bool all_near = std::ranges::all_of(slots, [&](std::uint32_t k) { return is_near(k); });
  if (!all_near || is_time_to_choose()) choose(slots);
}

}  // namespace montecarta::filters
