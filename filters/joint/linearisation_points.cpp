// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/linearisation_points.hpp"

namespace montecarta::filters {

void LinearisationPoints::start(const Pose& start) {
  pose_ = start;
  landmarks_.clear();
}

Eigen::Vector2d LinearisationPoints::behind(const Pose& place) const {
  return place_of(place) - place_of(pose_);
}

Eigen::Vector2d LinearisationPoints::shift_to(const CompressedGaussian& gaussian) const {
  Eigen::Vector2d sum = behind(gaussian.pose().mean);
  for (std::size_t slot = 0; slot < landmarks_.size(); ++slot) {
    sum += gaussian.mean_of(slot) - landmarks_[slot];
  }
  return sum / static_cast<double>(1 + landmarks_.size());
}

void LinearisationPoints::shift(const Eigen::Vector2d& way) {
  pose_.x += way(0);
  pose_.y += way(1);
  for (Eigen::Vector2d& landmark : landmarks_) landmark += way;
}

void LinearisationPoints::move(const LinearisedMotion& motion) {
  const Eigen::Vector2d way = -quarter_turned(motion.by_heading);
  pose_ = {pose_.x + way(0), pose_.y + way(1), motion.mean.heading};
}

Eigen::Vector2d turned(const ExpectedObservation& expected, const Eigen::Vector2d& place,
                       const Eigen::Vector2d& landmark) {
  return expected.pose_jacobian.leftCols<2>() * quarter_turned(place) +
         expected.pose_jacobian.col(2) + expected.landmark_jacobian * quarter_turned(landmark);
}

}  // namespace montecarta::filters
