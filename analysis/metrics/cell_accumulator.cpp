// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_accumulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

CellAccumulator::CellAccumulator(std::span<const double> times, double level,
                                 const BandWalks& walks)
    : times_(times),
      level_(level),
      walks_(&walks),
      run_bound_(nees_bounds(1, dimension_of(ErrorBlock::pose), level).upper),
      exits_(times.size()),
      credibility_(times.size()),
      moments_(times.size()),
      innovations_(times.size()) {}

void CellAccumulator::add(const RunRows& rows, const RunMetrics& metrics) {
  ++complete_;
  add_nees(metrics);
  if (!metrics.covariances().empty()) add_leading(metrics);
  if (!rows.nis.empty()) innovations_.add(rows.nis, rows.nis_dof);
  if (metrics.lineages() != nullptr) lineages_.add(*metrics.lineages());
  add_over_time(rows, metrics);
  scores_.push_back(scores_of(rows, metrics));
}

void CellAccumulator::add_nees(const RunMetrics& metrics) {
  if (complete_ == 1) {
    for (const Moments moments : kMoments) {
      if (metrics.nees(moments).value[0].empty()) continue;
      for (const ErrorBlock block : kErrorBlocks) nees_.emplace_back(block, moments, times_.size());
    }
  }
  if (!nees_.empty()) leading_ = nees_.front().moments();
  for (NeesAccumulator& nees : nees_) nees.add(metrics);
}

void CellAccumulator::add_leading(const RunMetrics& metrics) {
  const std::vector<double>& nees = metrics.nees(leading_).value[0];
  std::vector<bool> above;
  for (const double value : nees) above.push_back(value > run_bound_);
  const auto exit = first_lasting(above, kLastingScans);
  run_exits_.push_back(exit ? times_[*exit] : std::numeric_limits<double>::infinity());
  exits_.add(nees);
  credibility_.add(metrics.errors(), nees);
  moments_.add(metrics.errors(), metrics.covariances());
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

void CellAccumulator::put_leading(CellAnalysis& cell) {
  if (run_exits_.empty()) return;
  cell.run_exits = run_exits_;
  cell.credibility = credibility_.result();
  cell.anatomy = moments_.result();
  const auto pose = std::ranges::find_if(cell.nees, [&](const NeesResult& nees) {
    return nees.block == ErrorBlock::pose && nees.moments == leading_;
  });
  const auto exits = exits_.lasting_exits(times_, dimension_of(ErrorBlock::pose), level_);
  pose->consistency.exit_interval = middle_of(exits, level_);
}

CellAnalysis CellAccumulator::result() {
  CellAnalysis cell;
  cell.complete = complete_;
  cell.leading = leading_;
  for (const NeesAccumulator& nees : nees_) {
    cell.nees.push_back(nees.result(times_, level_, *walks_));
  }
  put_leading(cell);
  cell.error = errors();
  cell.weights = weights();
  cell.diversity = diversity();
  if (!lineages_.empty()) cell.lineages = lineages_.result();
  if (!innovations_.empty()) cell.innovations = innovations_.result(level_);
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
