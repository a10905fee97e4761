// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_accumulator.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace montecarta {
std::vector<double> MeanOverTime::mean() const {
  std::vector<double> means = sum_;
  for (double& mean : means) mean /= static_cast<double>(runs_);
  return means;
}

std::vector<double> MeanOverTime::root_mean() const {
  std::vector<double> roots = mean();
  for (double& root : roots) root = std::sqrt(root);
  return roots;
}

NeesAccumulator::NeesAccumulator(ErrorBlock block, Moments moments, std::size_t scans)
    : block_(block), moments_(moments), sum_(scans), runs_(scans), medians_(scans) {}

void NeesAccumulator::add(const RunMetrics& metrics) {
  const auto block = static_cast<std::size_t>(block_);
  const std::vector<double>& value = metrics.nees(moments_).value[block];
  const std::vector<std::uint8_t>& floored = metrics.nees(moments_).floored[block];
  samples_ += value.size();
  for (std::size_t s = 0; s < value.size(); ++s) {
    floored_ += floored[s];
    if (!std::isfinite(value[s])) {
      ++undefined_;
      continue;
    }
    sum_[s] += value[s];
    ++runs_[s];
    medians_.add(s, value[s]);
  }
}

NeesResult NeesAccumulator::result(std::span<const double> times, double level) const {
  NeesResult result;
  result.block = block_;
  result.moments = moments_;
  NeesSeries& series = result.series;
  series.dimension = dimension_of(block_);
  series.samples = samples_;
  series.floored = floored_;
  series.undefined = undefined_;
  series.runs = runs_;
  std::map<std::uint32_t, Interval> bounds_of;  // nearly always of one number of runs
  for (std::size_t s = 0; s < sum_.size(); ++s) {
    const auto [bounds, is_new] = bounds_of.try_emplace(runs_[s]);
    if (is_new && runs_[s] > 0) bounds->second = nees_bounds(runs_[s], series.dimension, level);
    series.bounds.push_back(bounds->second);
    series.average.push_back(sum_[s] / runs_[s]);  // NaN where no run is valid
    series.median.push_back(medians_.median(s));
  }
  result.consistency = judge(series, times, level);
  return result;
}

void CellAccumulator::add(const RunRows& rows, const RunMetrics& metrics) {
  ++complete_;
  if (!rows.mixture.mean.empty()) leading_ = Moments::mixture;
  add_nees(metrics);
  add_over_time(rows, metrics);
  scores_.push_back(scores_of(rows, metrics));
}

void CellAccumulator::add_nees(const RunMetrics& metrics) {
  if (complete_ == 1) {
    for (const Moments moments : {Moments::mixture, Moments::spread}) {
      if (metrics.nees(moments).value[0].empty()) continue;
      for (const ErrorBlock block : kErrorBlocks) nees_.emplace_back(block, moments, times_.size());
    }
  }
  for (NeesAccumulator& nees : nees_) nees.add(metrics);
}

void CellAccumulator::add_over_time(const RunRows& rows, const RunMetrics& metrics) {
  squared_position_.add(metrics.squared_position());
  squared_heading_.add(metrics.squared_heading());
  if (!rows.ess.empty()) ess_.add(rows.ess);
  if (rows.truth.empty() && !rows.map_size.empty()) map_size_.add(rows.map_size);
  if (metrics.diversity() == nullptr) return;
  last_resampling_.add(metrics.diversity()->last_resampling);
  lag_.add(metrics.diversity()->lag);
  root_.add(metrics.diversity()->root);
}

Summary CellAccumulator::over_runs(double RunScores::*score) const {
  SummaryOf sums;
  for (const RunScores& run : scores_) sums.add(run.*score);
  return sums.result();
}

ErrorSummary CellAccumulator::errors() const {
  ErrorSummary summary;
  summary.position_rmse = over_runs(&RunScores::position_rmse);
  summary.position_mse = over_runs(&RunScores::position_mse);
  summary.position_mean = over_runs(&RunScores::position_mean);
  summary.position_variance = over_runs(&RunScores::position_variance);
  summary.heading_rmse = over_runs(&RunScores::heading_rmse);
  summary.heading_mse = over_runs(&RunScores::heading_mse);
  summary.heading_mean = over_runs(&RunScores::heading_mean);
  summary.position_over_time = squared_position_.root_mean();
  summary.heading_over_time = squared_heading_.root_mean();
  return summary;
}

std::optional<WeightSummary> CellAccumulator::weights() const {
  if (ess_.empty()) return std::nullopt;
  return WeightSummary{over_runs(&RunScores::ess), over_runs(&RunScores::resampling_rate),
                       ess_.mean()};
}

std::optional<DiversitySummary> CellAccumulator::diversity() const {
  if (root_.empty()) return std::nullopt;
  return DiversitySummary{over_runs(&RunScores::last_resampling),
                          over_runs(&RunScores::lag),
                          over_runs(&RunScores::root),
                          over_runs(&RunScores::final_root),
                          last_resampling_.mean(),
                          lag_.mean(),
                          root_.mean()};
}

std::optional<AssociationSummary> CellAccumulator::association() const {
  const AssociationSummary summary{over_runs(&RunScores::correct), over_runs(&RunScores::wrong),
                                   over_runs(&RunScores::new_again), over_runs(&RunScores::missed),
                                   over_runs(&RunScores::clutter)};
  if (std::isnan(summary.correct.mean)) return std::nullopt;
  return summary;
}

CellAnalysis CellAccumulator::result() const {
  CellAnalysis cell;
  cell.complete = complete_;
  cell.leading = leading_;
  for (const NeesAccumulator& nees : nees_) cell.nees.push_back(nees.result(times_, level_));
  cell.error = errors();
  cell.weights = weights();
  cell.diversity = diversity();
  cell.association = association();
  cell.map_size_over_time = map_size_.mean();
  cell.scores = scores_;
  cell.cpu_seconds = over_runs(&RunScores::cpu_seconds);
  cell.numerical_faults = over_runs(&RunScores::numerical_faults);
  return cell;
}

const NeesResult* CellAnalysis::find_nees(ErrorBlock block, Moments moments) const {
  const auto found = std::ranges::find_if(nees, [&](const NeesResult& candidate) {
    return candidate.block == block && candidate.moments == moments;
  });
  return found == nees.end() ? nullptr : &*found;
}

Spread CellAnalysis::known_over_runs(double RunScores::*score) const {
  std::vector<double> values;
  for (const RunScores& run : scores) {
    if (!std::isnan(run.*score)) values.push_back(run.*score);
  }
  return spread_of(values);
}

Consistency CellAnalysis::consistency() const {
  const NeesResult* pose = find_nees(ErrorBlock::pose, leading);
  return pose == nullptr ? Consistency{} : pose->consistency;
}

}  // namespace montecarta
