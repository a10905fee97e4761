// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What a MarginalFilter tells of itself; included by marginal_filter.hpp.

#include "filters/marginal/marginal_filter.hpp"

namespace montecarta {

/// The drawn poses; between scans with the motion since then, as the kernels have it (SPEC 19).
template <class Real>
PoseEstimate MarginalFilter<Real>::estimate() const {
  if (is_drawn_) return {spread_of(weights_, poses_), std::nullopt};
  if (!moments_) moments_.emplace(weights_, poses_);
  return {moments_->moved_by(motion_).mixture.value(), std::nullopt};
}

template <class Real>
void MarginalFilter<Real>::particles(const ParticleColumns& columns) const {
  for (std::size_t i = 0; i < columns.pose.size() / 3; ++i) {
    const Pose drawn = pose_of_particle<Real>([&](std::size_t b) { return poses_[b]; }, i);
    const Pose pose = motion_.from(drawn).mean;
    columns.pose[3 * i] = pose.x;
    columns.pose[3 * i + 1] = pose.y;
    columns.pose[3 * i + 2] = pose.heading;
  }
  std::copy_n(weights_.log_scalars().begin(), columns.log_weight.size(),
              columns.log_weight.begin());
  std::copy_n(ancestors_.begin(), columns.ancestor.size(), columns.ancestor.begin());
}

template <class Real>
void MarginalFilter<Real>::map(std::span<std::optional<LandmarkEstimate>> landmarks) const {
  for (std::size_t k = 0; k < landmarks.size(); ++k) {
    const std::size_t slot = association_.slot_of_row(k);
    landmarks[k] = slot < map_.size() ? std::optional(estimate_of(map_[slot])) : std::nullopt;
  }
}

}  // namespace montecarta
