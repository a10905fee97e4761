// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What a FastSlam tells of itself; included by fast_slam.hpp.

#include "filters/fastslam/fast_slam.hpp"

namespace montecarta {

template <class Real, class Proposal, class Associating>
void FastSlam<Real, Proposal, Associating>::particles(const ParticleColumns& columns) const {
  const auto pose_of = [&](std::size_t i) {
    return pose_of_particle<Real>(
        [&](std::size_t b) { return proposal_.predicted(b, poses_[b]).mean; }, i);
  };
  population_.tell(columns, pose_of);
}

template <class Real, class Proposal, class Associating>
void FastSlam<Real, Proposal, Associating>::map(
    std::span<std::optional<LandmarkEstimate>> landmarks) const {
  for (std::size_t j = 0; j < landmarks.size(); ++j) landmarks[j] = landmark(j);
}

/// Known association: the mixture of all particles, by identity. Otherwise the heaviest particle's
/// map in the order in which it met its landmarks.
template <class Real, class Proposal, class Associating>
std::optional<LandmarkEstimate> FastSlam<Real, Proposal, Associating>::landmark(
    std::size_t j) const {
  if constexpr (Associating::kShared) {
    const std::int32_t slot = association_.slot_of(j);
    if (slot == Associating::kUnseen) return std::nullopt;
    maps_.copy_slot(static_cast<std::uint32_t>(slot), slot_source_, slot_blocks_);
    return mixture_of_landmarks(weights(), slot_blocks_);
  } else {
    const std::size_t heaviest = weights().heaviest();
    if (j >= association_.count_of(heaviest)) return std::nullopt;
    return maps_.landmark_of(static_cast<std::uint32_t>(j), static_cast<std::uint32_t>(heaviest));
  }
}

}  // namespace montecarta
