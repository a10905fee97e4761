// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/stored_map.hpp"

#include "analysis/data/met_drive.hpp"

#include <algorithm>
#include <span>
#include <string>

namespace montecarta::analysis {

StoredMap::StoredMap(const ResultFile& file, const StoredCell& cell, std::size_t run)
    : final_only_(!cell.has("map_seen")) {
  const std::string prefix = final_only_ ? "final_map_" : "map_";
  const auto column = std::ranges::find(cell.columns, prefix + "seen", &Column::name);
  if (column == cell.columns.end()) return;
  seen_.resize(column->elements());
  mean_.resize(2 * seen_.size());
  covariance_.resize(4 * seen_.size());
  landmarks_ = column->shape.back();
  scans_ = landmarks_ == 0 ? 0 : seen_.size() / landmarks_;
  scans_ = std::min(scans_, drive_met_by(file, file.runs()[run]).scan_times.size());
  file.read(cell, prefix + "seen", run, std::span(seen_));
  file.read(cell, prefix + "mean", run, std::span(mean_));
  file.read(cell, prefix + "covariance", run, std::span(covariance_));
}

std::vector<Ellipse> StoredMap::at(std::size_t scan) const {
  std::vector<Ellipse> ellipses;
  for (std::size_t k = scan * landmarks_; k < (scan + 1) * landmarks_; ++k) {
    if (seen_[k] == 0.0) continue;
    const double* P = covariance_.data() + 4 * k;
    ellipses.push_back(two_sigma_ellipse(mean_[2 * k], mean_[2 * k + 1], P[0], P[2], P[3]));
  }
  return ellipses;
}

}  // namespace montecarta::analysis
