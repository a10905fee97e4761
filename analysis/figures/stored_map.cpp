// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/stored_map.hpp"

#include "analysis/data/run_reader.hpp"
#include "engine/numbers/real.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

namespace montecarta::analysis {

Ellipse two_sigma_ellipse(double x, double y, double xx, double xy, double yy) {
  const double middle = 0.5 * (xx + yy);
  const double half_spread = length(0.5 * (xx - yy), xy);
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  const auto diameter = [](double variance) { return 4.0 * std::sqrt(variance); };
  return {x, y, diameter(middle + half_spread), diameter(middle - half_spread),
          angle * 180.0 / kPi};
}

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
