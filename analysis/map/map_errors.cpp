// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/map/map_errors.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta {
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
  runs_.emplace_back();
  if (!run) return;
  runs_.back() = {run->gospa, run->rms, run->nees};
  undefined_ += run->undefined;
  landmarks_.resize(run->landmarks.size());
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    const LandmarkScore& score = run->landmarks[l];
    if (!score.in_map) continue;
    Sums& sums = landmarks_[l];
    sums.squares += score.squared_error;
    ++sums.runs;
    if (!std::isfinite(score.nees)) continue;
    sums.nees += score.nees;
    ++sums.valid;
  }
}

std::string MapErrorSums::reason(bool known) const {
  if (!known) return "nobody knows where the landmarks are";
  if (runs_.empty()) return "no run is complete";
  const auto without = std::ranges::count_if(runs_, [](const auto& run) { return !run; });
  if (without == static_cast<std::ptrdiff_t>(runs_.size())) {
    return "maps are not stored, or not whole: add final_map to record.columns (and enlarge "
           "record.map_rows where it is given)";
  }
  if (without > 0) {
    return "the maps of " + std::to_string(without) +
           " runs are not whole: enlarge record.map_rows";
  }
  return {};
}

MapErrors MapErrorSums::result(double level, bool known) const {
  MapErrors errors;
  errors.missing = reason(known);
  if (!errors.missing.empty()) return errors;
  errors.gospa = over_runs([](const RunMap& map) { return map.gospa.distance; });
  errors.localisation = over_runs([](const RunMap& map) { return map.gospa.localisation; });
  errors.missed = over_runs([](const RunMap& map) { return map.gospa.missed; });
  errors.invented = over_runs([](const RunMap& map) { return map.gospa.invented; });
  if (landmarks_.empty()) return errors;
  errors.rms = over_runs([](const RunMap& map) { return map.rms; });
  errors.nees = over_runs([](const RunMap& map) { return map.nees; });
  errors.undefined = undefined_;
  for (const Sums& sums : landmarks_) {
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

Summary MapErrorSums::over_runs(double (*value_of)(const RunMap&)) const {
  SummaryOf sums;
  for (const auto& run : runs_) sums.add(value_of(*run));
  return sums.result();
}

void MapErrorSums::put_scores(std::vector<RunScores>& scores) const {
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    if (!runs_[i]) continue;
    scores[i].gospa = runs_[i]->gospa.distance;
    scores[i].gospa_localisation = runs_[i]->gospa.localisation;
    scores[i].landmarks_missed = runs_[i]->gospa.missed;
    scores[i].landmarks_invented = runs_[i]->gospa.invented;
    scores[i].landmark_rms = runs_[i]->rms;
    scores[i].landmark_nees = runs_[i]->nees;
  }
}

}  // namespace montecarta
