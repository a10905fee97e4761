// SPDX-License-Identifier: BSD-3-Clause
// The list of metrics, and the scores, numbers, sections and figures of all of them.
#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/metric.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace montecarta::analysis {

// The metrics, in the order of their numbers in files; Metric NAME_metric() is defined in metrics/.
// A new one is one line here.
#define MONTECARTA_METRICS(METRIC) \
  METRIC(errors)                   \
  METRIC(nees)                     \
  METRIC(verdict)                  \
  METRIC(imported)                 \
  METRIC(map_size)                 \
  METRIC(particles)                \
  METRIC(lineages)                 \
  METRIC(association)              \
  METRIC(references)               \
  METRIC(drive)                    \
  METRIC(beacons)                  \
  METRIC(bound)                    \
  METRIC(map)                      \
  METRIC(joint_nees)               \
  METRIC(error_envelopes)          \
  METRIC(innovations)              \
  METRIC(diversity)                \
  METRIC(calibration)              \
  METRIC(cost)                     \
  METRIC(convention_hints)         \
  METRIC(smoother)                 \
  METRIC(proper_scores)            \
  METRIC(observability)

#define MONTECARTA_DECLARED(NAME) Metric NAME##_metric();
MONTECARTA_METRICS(MONTECARTA_DECLARED)

std::span<const Metric> all_metrics() {
#define MONTECARTA_LISTED(NAME) NAME##_metric(),
  static const std::vector<Metric> all = {MONTECARTA_METRICS(MONTECARTA_LISTED)};
  return all;
}

namespace {

/// Mean, spread, standard error and interval of a score.
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
                    {"runs_spared", "1", count(cell.spared)},
                    {"looks_planned", "1", count(cell.looks_planned)},
                    {"looks_made", "1", count(cell.looks_made)},
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

const Score* find_score(std::string_view name) {
  const auto found = std::ranges::find(all_scores(), name, &Score::name);
  return found == all_scores().end() ? nullptr : &*found;
}

std::size_t index_of(std::string_view name) {
  const Score* score = find_score(name);
  expect(score != nullptr, "a score that no metric declares");
  return static_cast<std::size_t>(score - all_scores().data());
}

ScoreTable::ScoreTable() : columns_(all_scores().size()) {}

void ScoreTable::add(const MeasuredRun& run) {
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    columns_[k].push_back(all_scores()[k].of(run));
  }
  ++runs_;
}

void ScoreTable::add(std::span<const Value> values) {
  ++runs_;
  for (auto& column : columns_) column.resize(runs_, kNaN);
  for (const Value& value : values) columns_[index_of(value.name)].back() = value.value;
}

bool ScoreTable::is_whole() const {
  const auto is_full = [&](const std::vector<double>& column) { return column.size() == runs_; };
  return columns_.size() == all_scores().size() && std::ranges::all_of(columns_, is_full);
}

void ScoreTable::put(std::string_view name, std::vector<double> values) {
  expect(values.size() == runs_, "a score of other runs");
  columns_[index_of(name)] = std::move(values);
}

const std::vector<double>& ScoreTable::column(std::string_view name) const {
  return columns_[index_of(name)];
}

}  // namespace montecarta::analysis
