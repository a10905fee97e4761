// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace montecarta::engine {

/// Writes what was asked for of a filter's particles: `pose_of(i)`, normalised log weights, and
/// ancestors one scan ago.
template <class PoseOf>
void write_particle_columns(const ParticleColumns& columns, const PoseOf& pose_of,
                            std::span<const double> log_weights,
                            std::span<const std::uint32_t> ancestors) {
  for (std::size_t i = 0; i < columns.pose.size() / 3; ++i) {
    const Pose pose = pose_of(i);
    columns.pose[3 * i] = pose.x;
    columns.pose[3 * i + 1] = pose.y;
    columns.pose[3 * i + 2] = pose.heading;
  }
  std::copy_n(log_weights.begin(), columns.log_weight.size(), columns.log_weight.begin());
  std::copy_n(ancestors.begin(), columns.ancestor.size(), columns.ancestor.begin());
}

}  // namespace montecarta::engine
