// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_accumulator.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace montecarta {
namespace {

template <class Values>
double mean_of(const Values& values) {
  double sum = 0.0;
  for (const auto value : values) sum += static_cast<double>(value);
  return sum / static_cast<double>(values.size());
}

double mean_of_roots(const std::vector<double>& squares) {
  double sum = 0.0;
  for (const double square : squares) sum += std::sqrt(square);
  return sum / static_cast<double>(squares.size());
}

}  // namespace

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
  add_errors(metrics);
  if (!rows.ess.empty()) add_weights(rows);
  if (metrics.diversity() != nullptr) add_diversity(*metrics.diversity());
  add_effort(rows);
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

void CellAccumulator::add_errors(const RunMetrics& metrics) {
  const double position_mse = mean_of(metrics.squared_position());
  const double heading_mse = mean_of(metrics.squared_heading());
  const double distance = mean_of_roots(metrics.squared_position());
  error_.position_mse.add(position_mse);
  error_.position_rmse.add(std::sqrt(position_mse));
  error_.position_mean.add(distance);
  error_.position_variance.add(position_mse - distance * distance);
  error_.heading_mse.add(heading_mse);
  error_.heading_rmse.add(std::sqrt(heading_mse));
  error_.heading_mean.add(mean_of_roots(metrics.squared_heading()));
  error_.position.add(metrics.squared_position());
  error_.heading.add(metrics.squared_heading());
}

void CellAccumulator::add_weights(const RunRows& rows) {
  weights_.ess.add(mean_of(rows.ess));
  weights_.resampling_rate.add(mean_of(rows.resampled));
  weights_.ess_over_time.add(rows.ess);
}

void CellAccumulator::add_diversity(const Diversity& diversity) {
  diversity_.last_resampling.add(mean_of(diversity.last_resampling));
  diversity_.lag.add(mean_of(diversity.lag));
  diversity_.root.add(mean_of(diversity.root));
  diversity_.final_root.add(diversity.root.back());
  diversity_.last_resampling_over_time.add(diversity.last_resampling);
  diversity_.lag_over_time.add(diversity.lag);
  diversity_.root_over_time.add(diversity.root);
}

void CellAccumulator::add_effort(const RunRows& rows) {
  cpu_seconds_.add(rows.cpu_seconds);
  const auto& faults = rows.numerical_faults;
  numerical_faults_.add(
      static_cast<double>(std::accumulate(faults.begin(), faults.end(), std::uint64_t{0})));
}

ErrorSummary CellAccumulator::errors() const {
  ErrorSummary summary;
  summary.position_rmse = error_.position_rmse.result();
  summary.position_mse = error_.position_mse.result();
  summary.position_mean = error_.position_mean.result();
  summary.position_variance = error_.position_variance.result();
  summary.heading_rmse = error_.heading_rmse.result();
  summary.heading_mse = error_.heading_mse.result();
  summary.heading_mean = error_.heading_mean.result();
  summary.position_over_time = error_.position.root_mean();
  summary.heading_over_time = error_.heading.root_mean();
  return summary;
}

std::optional<WeightSummary> CellAccumulator::weights() const {
  if (weights_.ess_over_time.empty()) return std::nullopt;
  return WeightSummary{weights_.ess.result(), weights_.resampling_rate.result(),
                       weights_.ess_over_time.mean()};
}

std::optional<DiversitySummary> CellAccumulator::diversity() const {
  if (diversity_.root_over_time.empty()) return std::nullopt;
  return DiversitySummary{diversity_.last_resampling.result(),
                          diversity_.lag.result(),
                          diversity_.root.result(),
                          diversity_.final_root.result(),
                          diversity_.last_resampling_over_time.mean(),
                          diversity_.lag_over_time.mean(),
                          diversity_.root_over_time.mean()};
}

CellAnalysis CellAccumulator::result() const {
  CellAnalysis cell;
  cell.complete = complete_;
  cell.leading = leading_;
  for (const NeesAccumulator& nees : nees_) cell.nees.push_back(nees.result(times_, level_));
  cell.error = errors();
  cell.weights = weights();
  cell.diversity = diversity();
  cell.cpu_seconds = cpu_seconds_.result();
  cell.numerical_faults = numerical_faults_.result();
  return cell;
}

const NeesResult* CellAnalysis::find_nees(ErrorBlock block, Moments moments) const {
  const auto found = std::ranges::find_if(nees, [&](const NeesResult& candidate) {
    return candidate.block == block && candidate.moments == moments;
  });
  return found == nees.end() ? nullptr : &*found;
}

Consistency CellAnalysis::consistency() const {
  const NeesResult* pose = find_nees(ErrorBlock::pose, leading);
  return pose == nullptr ? Consistency{} : pose->consistency;
}

}  // namespace montecarta
