// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/cell_series.hpp"

#include "analysis/tables/verdict_table.hpp"

#include <limits>

namespace montecarta {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<double> ends_of(const std::vector<Interval>& bounds, double Interval::*end) {
  std::vector<double> ends;
  for (const Interval& interval : bounds) ends.push_back(interval.*end);
  return ends;
}

void add_nees(const NeesResult& nees, std::vector<NamedSeries>& all) {
  const NeesSeries& series = nees.series;
  const std::string suffix = "_" + name_of(nees.block) + "_" + name_of(nees.moments);
  all.push_back({"anees" + suffix, "1", series.average});
  all.push_back({"median_nees" + suffix, "1", series.median});
  all.push_back({"lower" + suffix, "1", ends_of(series.bounds, &Interval::lower)});
  all.push_back({"upper" + suffix, "1", ends_of(series.bounds, &Interval::upper)});
  all.push_back({"runs" + suffix, "1", {series.runs.begin(), series.runs.end()}});
}

/// Mean, spread and standard error of a Summary.
void add(const std::string& name, const std::string& units, const Summary& summary,
         std::vector<NamedNumber>& all) {
  all.push_back({name + "_mean", units, summary.mean});
  all.push_back({name + "_sd", units, summary.sd});
  all.push_back({name + "_standard_error", units, summary.standard_error()});
}

}  // namespace

std::vector<NamedSeries> series_of(const CellAnalysis& cell) {
  std::vector<NamedSeries> all;
  if (cell.complete == 0) return all;
  if (!cell.error.position_over_time.empty()) {
    all.push_back({"position_rmse", "m", cell.error.position_over_time});
    all.push_back({"heading_rmse", "rad", cell.error.heading_over_time});
  }
  for (const NeesResult& nees : cell.nees) add_nees(nees, all);
  if (!cell.map_size_over_time.empty()) {
    all.push_back({"map_landmarks", "1", cell.map_size_over_time});
  }
  if (cell.weights) all.push_back({"ess", "1", cell.weights->ess_over_time});
  if (cell.diversity) {
    all.push_back({"ancestors_last_resampling", "1", cell.diversity->last_resampling_over_time});
    all.push_back({"ancestors_10_s_ago", "1", cell.diversity->lag_over_time});
    all.push_back({"ancestors_at_start", "1", cell.diversity->root_over_time});
  }
  return all;
}

std::vector<NamedNumber> numbers_of(const CellAnalysis& cell) {
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  const WeightSummary weights = cell.weights.value_or(WeightSummary{});
  const DiversitySummary diversity = cell.diversity.value_or(DiversitySummary{});
  std::vector<NamedNumber> all = {{"runs_failed", "1", count(cell.failures.size())},
                                  {"runs_complete", "1", count(cell.complete)},
                                  {"runs_missing", "1", count(cell.missing)},
                                  {"particles", "1", count(cell.particles)}};
  add("position_rmse", "m", cell.error.position_rmse, all);
  add("position_mse", "m2", cell.error.position_mse, all);
  add("position_error", "m", cell.error.position_mean, all);
  add("position_error_variance_over_time", "m2", cell.error.position_variance, all);
  add("heading_rmse", "rad", cell.error.heading_rmse, all);
  add("heading_mse", "rad2", cell.error.heading_mse, all);
  add("heading_error", "rad", cell.error.heading_mean, all);
  add("ess", "1", weights.ess, all);
  add("resampling_rate", "1", weights.resampling_rate, all);
  add("ancestors_last_resampling", "1", diversity.last_resampling, all);
  add("ancestors_10_s_ago", "1", diversity.lag, all);
  add("ancestors_at_start", "1", diversity.root, all);
  add("ancestors_at_start_at_the_end", "1", diversity.final_root, all);
  const AssociationSummary association = cell.association.value_or(AssociationSummary{});
  add("association_correct", "1", association.correct, all);
  add("association_wrong", "1", association.wrong, all);
  add("association_new_again", "1", association.new_again, all);
  add("association_missed", "1", association.missed, all);
  add("association_clutter", "1", association.clutter, all);
  all.push_back({"position_efficiency", "1", cell.efficiency.position});
  all.push_back({"heading_efficiency", "1", cell.efficiency.heading});
  all.push_back({"map_efficiency", "1", cell.efficiency.map});
  add("landmark_rms", "m", cell.map.rms, all);
  add("landmark_nees", "1", cell.map.nees, all);
  add("gospa", "m", cell.map.gospa, all);
  add("gospa_localisation", "m", cell.map.localisation, all);
  add("landmarks_missed", "1", cell.map.missed, all);
  add("landmarks_invented", "1", cell.map.invented, all);
  all.push_back({"landmarks_undefined", "1", count(cell.map.undefined)});
  add("numerical_faults", "1", cell.numerical_faults, all);
  add("cpu_seconds", "s", cell.cpu_seconds, all);
  return all;
}

std::vector<NamedNumber> numbers_of(const CellAnalysis& cell, const NeesResult& nees,
                                    double level) {
  const Consistency& found = nees.consistency;
  const Interval band = nees_bounds(cell.complete, nees.series.dimension, level);
  return {{"level", "1", level},
          {"dimension", "1", static_cast<double>(nees.series.dimension)},
          {"anees_mean", "1", found.mean},
          {"nees_median", "1", found.median},
          {"lower", "1", band.lower},
          {"upper", "1", band.upper},
          {"share_inside", "1", found.share_inside},
          {"share_above", "1", found.share_above},
          {"share_below", "1", found.share_below},
          {"lasting_exit_s", "s", found.lasting_exit.value_or(kNaN)},
          {"samples", "1", static_cast<double>(nees.series.samples)},
          {"floored", "1", static_cast<double>(nees.series.floored)},
          {"undefined", "1", static_cast<double>(nees.series.undefined)}};
}

}  // namespace montecarta
