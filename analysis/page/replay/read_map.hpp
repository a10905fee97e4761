// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/page/replay/replay.hpp"
#include "engine/records/result_file.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// The landmarks a cell had, at as many of the frames, evenly, as `ellipses` in all allow; where
/// only the final map is stored that one, at the last frame; else nothing.
std::vector<ReplayMap> read_maps(const ResultFile& file, const StoredCell& cell, std::size_t run,
                                 std::span<const std::size_t> frame_scans, std::size_t ellipses);

}  // namespace montecarta::analysis
