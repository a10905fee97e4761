// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/page/replay/replay.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// What is stored of a cell's particles in one run.
struct StoredParticles {
  std::size_t count = 0;                    ///< particles
  std::span<const double> pose;             ///< {scan, particle, 3}
  std::span<const std::uint32_t> ancestor;  ///< {scan, particle}; empty: not stored
};

/// At most `most` particles a frame; `scans`, increasing, are those of the frames. The last frame
/// shows particles evenly over their indices, every earlier one the parents of the frame behind it
/// and, evenly, as many others as there is room for.
ReplayParticles thin_particles(const StoredParticles& stored, std::span<const std::size_t> scans,
                               std::size_t most);

}  // namespace montecarta::analysis
