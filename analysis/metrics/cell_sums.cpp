// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_sums.hpp"

#include "analysis/statistics/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta {
namespace {

/// Fills CellAnalysis::score_intervals, and Consistency::average_interval of every test from its
/// runs: one bootstrap over runs at `level`.
void put_score_intervals(CellAnalysis& cell, double level) {
  std::vector<std::vector<double>> columns;
  for (const Score& score : all_scores()) columns.push_back(cell.scores.column(score));
  for (const NeesResult& nees : cell.nees) columns.push_back(nees.series.run_averages);
  std::vector<Interval> intervals = bootstrap_means(columns, level);
  const std::size_t scores = all_scores().size();
  for (std::size_t k = 0; k < cell.nees.size(); ++k) {
    cell.nees[k].consistency.average_interval = intervals[scores + k];
  }
  intervals.resize(scores);
  cell.score_intervals = std::move(intervals);
}

}  // namespace

void MeanOverTime::add(const std::vector<double>& values) {
  sum_.resize(values.size());
  for (std::size_t s = 0; s < sum_.size(); ++s) sum_[s] += values[s];
  ++runs_;
}

std::vector<double> MeanOverTime::mean() const {
  std::vector<double> means = sum_;
  for (double& mean : means) mean /= static_cast<double>(runs_);
  return means;
}

CellSums::CellSums(const Yardsticks& sticks)
    : sticks_(&sticks),
      run_bound_(nees_bounds(1, dimension_of(ErrorBlock::pose), sticks.level).upper),
      over_time_(all_scan_series().size()),
      exits_(sticks.times.size()),
      credibility_(sticks.times.size()),
      moments_(sticks.times.size()),
      innovations_(sticks.times.size()),
      references_(sticks.references.size()) {}

void CellSums::add(const MeasuredRun& run) {
  scores_.add(run);
  for (std::size_t k = 0; k < over_time_.size(); ++k) {
    const std::vector<double> values = all_scan_series()[k].of(run);
    if (!values.empty()) over_time_[k].add(values);
  }
  add_nees(run.metrics);
  if (!run.metrics.covariances().empty()) add_leading(run.metrics);
  if (!run.rows.nis.empty()) innovations_.add(run.rows.nis, run.rows.nis_dof);
  if (run.metrics.lineages() != nullptr) lineages_.add(*run.metrics.lineages());
  for (std::size_t r = 0; r < references_.size(); ++r) references_[r].add(run.references[r]);
  map_.add(run.map);
  joint_.add(run.joint);
  if (sticks_->calibrates) calibration_.add(run.pits);
}

void CellSums::add_nees(const RunMetrics& metrics) {
  if (scores_.runs() == 1) {
    for (const Moments moments : kMoments) {
      if (metrics.nees(moments).value[0].empty()) continue;
      for (const ErrorBlock block : kErrorBlocks) {
        nees_.emplace_back(block, moments, sticks_->times.size());
      }
    }
  }
  if (!nees_.empty()) leading_ = nees_.front().moments();
  for (NeesAccumulator& nees : nees_) nees.add(metrics);
}

void CellSums::add_leading(const RunMetrics& metrics) {
  const std::vector<double>& nees = metrics.nees(leading_).value[0];
  std::vector<bool> above;
  for (const double value : nees) above.push_back(value > run_bound_);
  const auto exit = first_lasting(above, kLastingScans);
  run_exits_.push_back(exit ? sticks_->times[*exit] : std::numeric_limits<double>::infinity());
  exits_.add(nees);
  credibility_.add(metrics.errors(), nees);
  moments_.add(metrics.errors(), metrics.covariances());
}

void CellSums::put_leading(CellAnalysis& cell) {
  if (run_exits_.empty()) return;
  cell.run_exits = run_exits_;
  cell.credibility = credibility_.result();
  cell.anatomy = moments_.result();
  const auto pose = std::ranges::find_if(cell.nees, [&](const NeesResult& nees) {
    return nees.block == ErrorBlock::pose && nees.moments == leading_;
  });
  const auto exits =
      exits_.lasting_exits(sticks_->times, dimension_of(ErrorBlock::pose), sticks_->level);
  pose->consistency.exit_interval = middle_of(exits, sticks_->level);
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

CellAnalysis CellSums::result() {
  CellAnalysis cell;
  const double level = sticks_->level;
  cell.complete = scores_.runs();
  cell.leading = leading_;
  for (const NeesAccumulator& nees : nees_) {
    cell.nees.push_back(nees.result(sticks_->times, level, sticks_->walks));
  }
  put_leading(cell);
  put_series(cell);
  if (!lineages_.empty()) cell.lineages = lineages_.result();
  if (!innovations_.empty()) cell.innovations = innovations_.result(level);
  for (const ReferenceAccumulator& sums : references_) cell.references.push_back(sums.result());
  cell.map = map_.result(level, sticks_->map.known);
  cell.joint = joint_.result(level, sticks_->map.identities_known);
  cell.calibration = calibration_.result(sticks_->times, level);
  cell.scores = scores_;
  put_score_intervals(cell, level);
  return cell;
}

std::vector<MeasuredRun> slots_for(const Parallel& parallel) {
  return std::vector<MeasuredRun>(
      parallel.threads() == 1 ? 1 : 4 * static_cast<std::size_t>(parallel.threads()));
}

void add_runs(const RunReader& reader, std::span<const std::size_t> runs, std::size_t particles,
              const Yardsticks& sticks, const Parallel& parallel, std::vector<MeasuredRun>& slots,
              CellSums& sums) {
  for (std::size_t first = 0; first < runs.size(); first += slots.size()) {
    const std::size_t here = std::min(slots.size(), runs.size() - first);
    parallel.for_each(here, [&](std::size_t k) {
      reader.read(runs[first + k], slots[k].rows, slots[k].scratch);
      slots[k].measure(sticks, particles);
    });
    for (std::size_t k = 0; k < here; ++k) sums.add(slots[k]);
  }
}

}  // namespace montecarta
