// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_sums.hpp"

#include "analysis/statistics/bootstrap.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

/// Fills CellAnalysis::score_intervals, and NeesResult::average_interval of every NEES from its
/// runs: one bootstrap over runs at `level`, and one over the judged runs where some are not.
void put_score_intervals(CellAnalysis& cell, double level) {
  std::vector<std::vector<double>> columns;
  for (const Score& score : all_scores()) columns.push_back(cell.scores.column(score.name));
  for (const NeesResult& nees : cell.nees) {
    columns.push_back(nees.series.unjudged_runs == 0 ? nees.series.run_averages
                                                     : std::vector<double>(cell.complete, kNaN));
  }
  std::vector<Interval> intervals = bootstrap_means(columns, level);
  const std::size_t scores = all_scores().size();
  for (std::size_t k = 0; k < cell.nees.size(); ++k) {
    NeesResult& nees = cell.nees[k];
    nees.average_interval = nees.series.unjudged_runs == 0
                                ? intervals[scores + k]
                                : bootstrap_mean(nees.series.run_averages, level);
  }
  intervals.resize(scores);
  cell.score_intervals = std::move(intervals);
}

}  // namespace

void MeanOverTime::add(const std::vector<double>& values) {
  sum_.resize(values.size());
  for (std::size_t s = 0; s < values.size(); ++s) sum_[s] += values[s];
  runs_ += 1.0;
}

std::vector<double> MeanOverTime::mean() const {
  std::vector<double> means = sum_;
  for (double& mean : means) mean /= runs_;
  return means;
}

CellSums::CellSums(const RunCriteria& criteria)
    : level_(criteria.level), over_time_(criteria.drives.empty() ? all_scan_series().size() : 0) {
  for (const Metric& metric : all_metrics()) {
    if (metric.sums != nullptr) metrics_.push_back(metric.sums(criteria));
  }
}

void CellSums::add(std::span<const MeasuredRun> runs, const Parallel& parallel) {
  parallel.for_each(metrics_.size() + 2, [&](std::size_t part) {
    for (const MeasuredRun& run : runs) {
      if (part < metrics_.size()) metrics_[part]->add(run);
      if (part == metrics_.size()) scores_.add(run);
      if (part > metrics_.size()) add_to_series(run);
    }
  });
}

void CellSums::add_to_series(const MeasuredRun& run) {
  for (std::size_t k = 0; k < over_time_.size(); ++k) {
    const std::vector<double> values = all_scan_series()[k].of(run);
    if (!values.empty()) over_time_[k].add(values);
  }
}

void CellSums::put_series(CellAnalysis& cell) const {
  for (std::size_t k = 0; k < over_time_.size(); ++k) {
    if (over_time_[k].empty()) continue;
    const ScanSeries& series = all_scan_series()[k];
    std::vector<double> values = over_time_[k].mean();
    if (series.is_square) {
      for (double& value : values) value = std::sqrt(value);
    }
    cell.scan_series.push_back({series.name, series.units, std::move(values)});
  }
}

void CellSums::put(CellAnalysis& cell) {
  cell.complete = scores_.runs();
  put_series(cell);
  cell.scores = scores_;
  for (const auto& metric : metrics_) metric->put(cell);
  put_score_intervals(cell, level_);
}

void add_runs(const RunReader& reader, std::span<const std::size_t> runs, std::size_t particles,
              const RunCriteria& criteria, const Parallel& parallel, std::size_t cells,
              CellSums& sums) {
  const auto threads = static_cast<std::size_t>(parallel.threads());
  const std::size_t at_once = threads == 1 ? 1 : (4 * threads + cells - 1) / cells;
  std::vector<MeasuredRun> slots(std::min(at_once, runs.size()));
  for (std::size_t first = 0; first < runs.size(); first += slots.size()) {
    const std::size_t here = std::min(slots.size(), runs.size() - first);
    parallel.for_each(here, [&](std::size_t k) {
      reader.read(runs[first + k], slots[k].rows, slots[k].scratch);
      slots[k].measure(criteria, particles);
    });
    sums.add(std::span(slots).first(here), parallel);
  }
}

std::vector<double> first_values(const ResultFile& file, const StoredCell& cell, const Score& score,
                                 std::size_t runs, const Parallel& parallel) {
  const std::vector<RunStatus> status = file.status(cell);
  std::vector<std::size_t> complete;
  for (std::size_t i = 0; i < runs; ++i) {
    if (status[i] == RunStatus::complete) complete.push_back(i);
  }
  const RunCriteria criteria = criteria_of(file, 0.95);
  CellSums sums(criteria);
  add_runs(RunReader(file, cell), complete, cell.particles, criteria, parallel, 1, sums);
  return sums.scores().column(score.name);
}

double half_width(const std::vector<double>& values, double level) {
  if (values.size() < 2) return std::numeric_limits<double>::infinity();
  SummaryOf sums;
  for (const double value : values) sums.add(value);
  return t_quantile(values.size(), level) * sums.result().standard_error();
}

bool is_precise(const std::vector<double>& values, double level, double wanted) {
  return half_width(values, level) < wanted && !is_heavy_tailed(values);
}

}  // namespace montecarta::analysis
