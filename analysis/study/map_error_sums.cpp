// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/map_error_sums.hpp"

#include "analysis/statistics/nees_bounds.hpp"

#include <cmath>

namespace montecarta::analysis {

double MapErrors::share_inside() const {
  double inside = 0.0, tested = 0.0;
  for (const LandmarkErrors& one : landmarks) {
    if (one.valid == 0) continue;
    tested += 1.0;
    inside += one.anees >= one.bounds.lower && one.anees <= one.bounds.upper ? 1.0 : 0.0;
  }
  return inside / tested;
}

void MapErrorSums::add(const std::optional<MapScores>& run) {
  ++n_runs_;
  if (!run) return;
  ++n_maps_;
  undefined_ += run->undefined;
  landmarks_.resize(run->landmarks.size());
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    const LandmarkScore& score = run->landmarks[l];
    if (!score.in_map) continue;
    LandmarkSums& sums = landmarks_[l];
    sums.squares += score.squared_error;
    ++sums.runs;
    if (!std::isfinite(score.nees)) continue;
    sums.nees += score.nees;
    ++sums.valid;
  }
}

std::string MapErrorSums::reason(const MapCriteria& map) const {
  if (map.is_exact) return "the filter is given the map and takes it to be exact";
  if (!map.known) return "nobody knows where the landmarks are";
  if (n_runs_ == 0) return "no run is complete";
  if (n_maps_ == 0) {
    return "maps are not stored, or not whole: add final_map to record.columns (and enlarge "
           "record.map_rows where it is given)";
  }
  if (n_maps_ < n_runs_) {
    return "the maps of " + std::to_string(n_runs_ - n_maps_) +
           " runs are not whole: enlarge record.map_rows";
  }
  return {};
}

MapErrors MapErrorSums::result(double level, const MapCriteria& map) const {
  MapErrors errors;
  errors.missing = reason(map);
  if (!errors.missing.empty()) return errors;
  if (landmarks_.empty()) return errors;
  errors.undefined = undefined_;
  for (const LandmarkSums& sums : landmarks_) {
    LandmarkErrors one{.runs = sums.runs, .valid = sums.valid};
    if (sums.runs > 0) one.rms = std::sqrt(sums.squares / sums.runs);
    if (sums.valid > 0) {
      one.anees = sums.nees / sums.valid;
      one.bounds = nees_bounds(sums.valid, 2, level);
    }
    errors.landmarks.push_back(one);
  }
  return errors;
}

}  // namespace montecarta::analysis
