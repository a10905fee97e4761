// SPDX-License-Identifier: BSD-3-Clause
// The list of metrics, and the scores, numbers, sections and figures of all of them.
#include "analysis/study/registry.hpp"

#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/score_table.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace montecarta::analysis {

// NAME_metric() is defined in metrics/NAME.cpp, except beacons_metric() in map_size.cpp and
// particles_metric() in diversity.cpp.
Metric errors_metric(), consistency_metric(), verdict_metric(), families_metric(),
    components_metric(), blocks_metric(), map_size_metric(), particles_metric(), lineages_metric(),
    association_metric(), references_metric(), drive_metric(), beacons_metric(), bound_metric(),
    map_errors_metric(), joint_nees_metric(), error_envelopes_metric(), innovations_metric(),
    diversity_metric(), calibration_metric(), cost_metric(), convention_hints_metric(),
    smoother_metric(), proper_scores_metric(), observability_metric(), evolution_metric(),
    sweep_metric(), own_drives_metric();

std::span<const Metric> all_metrics() {
  // The order is that of their numbers in files.
  static constexpr std::array kMakers = {
      errors_metric,           consistency_metric,     verdict_metric,
      families_metric,         components_metric,      blocks_metric,
      map_size_metric,         particles_metric,       lineages_metric,
      association_metric,      references_metric,      drive_metric,
      beacons_metric,          bound_metric,           map_errors_metric,
      joint_nees_metric,       error_envelopes_metric, innovations_metric,
      diversity_metric,        calibration_metric,     cost_metric,
      convention_hints_metric, smoother_metric,        proper_scores_metric,
      observability_metric,    evolution_metric,       sweep_metric,
      own_drives_metric};
  static const std::vector<Metric> all = [] {
    std::vector<Metric> made;
    for (Metric (*make)() : kMakers) made.push_back(make());
    return made;
  }();
  return all;
}

namespace {

/// Adds mean, spread, standard error and interval of a score.
void add_score(const CellAnalysis& cell, const Score& score, Frame::Row& all) {
  const Summary summary = cell.over_runs(score.name);
  const Interval interval = cell.interval_of(score.name);
  const std::string prefix = std::string(score.name) + "_";
  all.emplace_back(prefix + "mean", score.units, summary.mean);
  all.emplace_back(prefix + "sd", score.units, summary.sd);
  all.emplace_back(prefix + "standard_error", score.units, summary.standard_error());
  all.emplace_back(prefix + "lower", score.units, interval.lower);
  all.emplace_back(prefix + "upper", score.units, interval.upper);
}

}  // namespace

Frame::Row numbers_of(const CellAnalysis& cell) {
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  Frame::Row all = {{"runs_failed", "1", count(cell.failures.size())},
                    {"runs_complete", "1", count(cell.complete)},
                    {"runs_missing", "1", count(cell.missing)},
                    {"runs_not_needed", "1", count(cell.not_needed)},
                    {"interim_analyses_planned", "1", count(cell.analyses_planned)},
                    {"interim_analyses_made", "1", count(cell.analyses_made)},
                    {"particles", "1", count(cell.particles)}};
  for (const Metric& metric : all_metrics()) {
    if (metric.scores_are_numbers) {
      for (const Score& score : metric.scores) add_score(cell, score, all);
    }
    if (metric.add_numbers != nullptr) metric.add_numbers(cell, all);
  }
  return all;
}

std::vector<Frame::Column> series_of(const CellAnalysis& cell) {
  std::vector<Frame::Column> all;
  if (cell.complete == 0) return all;
  for (const Metric& metric : all_metrics()) {
    for (const ScanSeries& series : metric.scan_series) {
      const auto found = std::ranges::find(cell.scan_series, series.name, &Frame::Column::name);
      if (found != cell.scan_series.end()) all.push_back(*found);
    }
    if (metric.add_series != nullptr) metric.add_series(cell, all);
  }
  for (const Frame::Column& series : all) {
    expect(series.numbers.size() == all.front().numbers.size(),
           "a series has a value for each scan");
  }
  return all;
}

std::vector<Section> sections_of(const StudyAnalysis& study) {
  std::vector<Section> all;
  for (const Metric& metric : all_metrics()) {
    if (metric.sections == nullptr) continue;
    std::ranges::move(metric.sections(study), std::back_inserter(all));
  }
  return all;
}

std::vector<Figure> figures_of(const StudyAnalysis& study) {
  std::vector<Figure> all;
  for (const Metric& metric : all_metrics()) {
    if (metric.figures == nullptr) continue;
    std::ranges::move(metric.figures(study), std::back_inserter(all));
  }
  std::erase_if(all, [](const Figure& figure) { return figure.data.empty(); });
  return all;
}

namespace {

template <class T>
std::vector<T> all_of(std::span<const T> Metric::*list) {
  std::vector<T> all;
  for (const Metric& metric : all_metrics()) {
    all.insert(all.end(), (metric.*list).begin(), (metric.*list).end());
  }
  return all;
}

}  // namespace

std::span<const Score> all_scores() {
  static const std::vector<Score> all = all_of(&Metric::scores);
  return all;
}

std::span<const ScanSeries> all_scan_series() {
  static const std::vector<ScanSeries> all = all_of(&Metric::scan_series);
  return all;
}

}  // namespace montecarta::analysis
