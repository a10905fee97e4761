// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/cell_series.hpp"

#include "analysis/tables/verdict_table.hpp"

#include <algorithm>
#include <initializer_list>
#include <string_view>

namespace montecarta {
namespace {

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
  all.push_back({"trimmed_nees" + suffix, "1", series.trimmed});
  all.push_back(
      {"whole_run_lower" + suffix, "1", ends_of(series.whole_run_bounds, &Interval::lower)});
  all.push_back(
      {"whole_run_upper" + suffix, "1", ends_of(series.whole_run_bounds, &Interval::upper)});
  all.push_back({"runs" + suffix, "1", {series.runs.begin(), series.runs.end()}});
}

void add_anatomy(const ErrorAnatomy& anatomy, std::vector<NamedSeries>& all) {
  for (std::size_t c = 0; c < kErrorComponents.size(); ++c) {
    const std::string name = kErrorComponents[c];
    const std::string units = name == "heading" ? "rad" : "m";
    all.push_back({"rms_error_" + name, units, anatomy.happened[c]});
    all.push_back({"believed_deviation_" + name, units, anatomy.believed[c]});
    all.push_back({"mean_error_" + name, units, anatomy.bias[c]});
  }
  all.push_back({"bias_share", "1", anatomy.bias_share});
  all.push_back({"worst_variance_ratio", "1", anatomy.worst_ratio});
}

void add_survival(const Survival& survival, std::vector<NamedSeries>& all) {
  all.push_back({"runs_right", "1", survival.share});
  all.push_back({"runs_right_lower", "1", ends_of(survival.interval, &Interval::lower)});
  all.push_back({"runs_right_upper", "1", ends_of(survival.interval, &Interval::upper)});
}

void add_innovations(const Innovations& innovations, std::vector<NamedSeries>& all) {
  all.push_back({"nis_per_component", "1", innovations.average});
  all.push_back({"nis_lower", "1", ends_of(innovations.bounds, &Interval::lower)});
  all.push_back({"nis_upper", "1", ends_of(innovations.bounds, &Interval::upper)});
}

}  // namespace

std::vector<NamedSeries> series_of(const CellAnalysis& cell) {
  std::vector<NamedSeries> all;
  const auto add_scan_series = [&](std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) {
      const auto found = std::ranges::find(cell.scan_series, name, &NamedSeries::name);
      if (found != cell.scan_series.end()) all.push_back(*found);
    }
  };
  if (cell.complete == 0) return all;
  add_scan_series({"position_rmse", "heading_rmse"});
  for (const NeesResult& nees : cell.nees) add_nees(nees, all);
  add_scan_series({"map_landmarks"});
  if (cell.anatomy) add_anatomy(*cell.anatomy, all);
  if (cell.survival && !cell.survival->share.empty()) add_survival(*cell.survival, all);
  if (cell.innovations) add_innovations(*cell.innovations, all);
  add_scan_series({"ess", "ancestors_last_resampling", "ancestors_10_s_ago", "ancestors_at_start"});
  return all;
}

}  // namespace montecarta
