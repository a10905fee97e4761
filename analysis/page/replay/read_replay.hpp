// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/page/replay/replay.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <span>
#include <vector>

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

/// The landmarks a cell had, at as many of the frames, evenly, as `ellipses` in all allow; where
/// only the final map is stored that one, at the last frame; else nothing.
std::vector<ReplayMap> read_maps(const ResultFile& file, const StoredCell& cell, std::size_t run,
                                 std::span<const std::size_t> frame_scans, std::size_t ellipses);

}  // namespace montecarta::analysis
