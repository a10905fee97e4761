// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"
#include "filters/association/nearest.hpp"

#include <cstdint>
#include <span>

namespace montecarta {

/// What one map's pairings of a scan are, seen with the simulator's eyes. `made_of` {slot}: the
/// identity of the detection that each landmark of the map was made of, before this scan's new
/// ones. Counting only: no estimate may depend on it.
AssociationCounts association_counts(Scan scan, std::span<const Pairing> pairings,
                                     std::span<const std::int32_t> made_of);

/// Adds `share` times the counts of one particle.
void add(const AssociationCounts& counts, double share, AssociationCounts& sum);

}  // namespace montecarta
