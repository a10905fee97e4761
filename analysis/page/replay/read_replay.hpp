// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/page/replay/replay.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>

namespace montecarta::analysis {

/// How much of a run a page can carry: some megabytes over all cells.
struct ReplaySize {
  std::size_t frames = 400;         ///< at most
  std::size_t particles = 100;      ///< of a cell in a frame, at most
  std::size_t positions = 300'000;  ///< of particles, over all cells and frames
  std::size_t ellipses = 30'000;    ///< of landmarks, over all cells and frames
};

/// Reads run index `run` of every cell that completed it or failed in it, thinned in time to equal
/// steps from scan to scan.
Replay read_replay(const ResultFile& file, std::size_t run, const ReplaySize& size = {});

}  // namespace montecarta::analysis
