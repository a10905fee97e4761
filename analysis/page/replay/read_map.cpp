// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/replay/read_map.hpp"

#include "analysis/figures/stored_map.hpp"

#include <algorithm>

namespace montecarta::analysis {

std::vector<ReplayMap> read_maps(const ResultFile& file, const StoredCell& cell, std::size_t run,
                                 std::span<const std::size_t> frame_scans, std::size_t ellipses) {
  const StoredMap stored(file, cell, run);
  if (stored.scans() == 0) return {};
  const std::size_t frames = frame_scans.size();
  if (stored.is_final_only()) return {{frames - 1, stored.at(0)}};
  std::vector<ReplayMap> maps;
  const std::size_t count = std::clamp<std::size_t>(ellipses / stored.landmarks(), 1, frames);
  for (std::size_t k = 1; k <= count; ++k) {
    const std::size_t frame = k * frames / count - 1;
    maps.push_back({frame, stored.at(frame_scans[frame])});
  }
  return maps;
}

}  // namespace montecarta::analysis
