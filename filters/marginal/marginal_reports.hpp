// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What a MarginalFilter tells of itself; included by marginal_filter.hpp.

#include "filters/marginal/marginal_filter.hpp"

namespace montecarta {

/// The drawn poses; between scans with the motion since then, as the kernels have it (SPEC 19).
template <class Real>
PoseEstimate MarginalFilter<Real>::estimate() const {
  if (is_drawn_) return {spread_of(weights(), poses_), std::nullopt};
  if (!moments_) moments_.emplace(weights(), poses_);
  return {moments_->moved_by(motion_).mixture.value(), std::nullopt};
}

template <class Real>
void MarginalFilter<Real>::particles(const ParticleColumns& columns) const {
  const auto pose_of = [&](std::size_t i) {
    return motion_.from(pose_of_particle<Real>([&](std::size_t b) { return poses_[b]; }, i)).mean;
  };
  population_.tell(columns, pose_of);
}

template <class Real>
void MarginalFilter<Real>::map(std::span<std::optional<LandmarkEstimate>> landmarks) const {
  for (std::size_t k = 0; k < landmarks.size(); ++k) {
    const std::size_t slot = association_.slot_of_row(k);
    landmarks[k] = slot < map_.size() ? std::optional(estimate_of(map_[slot])) : std::nullopt;
  }
}

}  // namespace montecarta
