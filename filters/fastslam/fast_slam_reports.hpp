// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What a FastSlam tells of itself; included by fast_slam.hpp.

#include "filters/fastslam/fast_slam.hpp"

namespace montecarta {

template <class Real, class Proposal, class Associating>
void FastSlam<Real, Proposal, Associating>::report_innovations() {
  for (std::size_t k = 0; k < association_.matches(); ++k) {
    if (matched_weights_[k] < 0.5) continue;  // most of the filter takes it for something else
    report_.nis += innovations_.normalised_squared(k, matched_weights_[k]);
    report_.nis_dof += 2;
  }
}

template <class Real, class Proposal, class Associating>
void FastSlam<Real, Proposal, Associating>::particles(const ParticleColumns& columns) const {
  for (std::size_t i = 0; i < columns.pose.size() / 3; ++i) {
    const BasicPose<Real> pose = proposal_.predicted(poses_[i / kLanesOf<Real>]).mean;
    const std::size_t lane = i % kLanesOf<Real>;
    columns.pose[3 * i] = get(pose.x, lane);
    columns.pose[3 * i + 1] = get(pose.y, lane);
    columns.pose[3 * i + 2] = get(pose.heading, lane);
  }
  std::copy_n(weights_.log_scalars().begin(), columns.log_weight.size(),
              columns.log_weight.begin());
  std::copy_n(ancestors_.begin(), columns.ancestor.size(), columns.ancestor.begin());
}

template <class Real, class Proposal, class Associating>
void FastSlam<Real, Proposal, Associating>::map(
    std::span<std::optional<LandmarkEstimate>> landmarks) const {
  std::vector<std::uint32_t> source;
  std::vector<LandmarkGaussian<Real>> blocks;
  for (std::size_t j = 0; j < landmarks.size(); ++j) {
    landmarks[j].reset();
    const std::int32_t slot = association_.slot_of(j);
    if (slot < 0 || static_cast<std::size_t>(slot) >= maps_.slots()) continue;
    maps_.copy_slot(static_cast<std::uint32_t>(slot), source, blocks);
    landmarks[j] = mixture_of_landmarks(weights_, blocks, [&](std::size_t b) {
      return association_.owners(static_cast<std::uint32_t>(slot), b);
    });
  }
}

}  // namespace montecarta
