// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/median_table.hpp"
#include "analysis/metrics/run_metrics.hpp"
#include "analysis/metrics/run_rows.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace montecarta {

/// Adds up the NEES of one block by one definition over runs.
class NeesAccumulator {
 public:
  NeesAccumulator(ErrorBlock block, Moments moments, std::size_t scans);
  void add(const RunMetrics& metrics);
  NeesResult result(std::span<const double> times, double level) const;

 private:
  ErrorBlock block_;
  Moments moments_;
  std::vector<double> sum_;          ///< {scan} of finite NEES
  std::vector<std::uint32_t> runs_;  ///< {scan} in the sum
  MedianTable medians_;
  std::uint64_t samples_ = 0, floored_ = 0, undefined_ = 0;
};

/// Adds up a number of every scan over runs.
class MeanOverTime {
 public:
  template <class Values>
  void add(const Values& values) {
    sum_.resize(values.size());
    for (std::size_t s = 0; s < sum_.size(); ++s) sum_[s] += static_cast<double>(values[s]);
    ++runs_;
  }
  bool empty() const { return runs_ == 0; }
  std::vector<double> mean() const;
  std::vector<double> root_mean() const;

 private:
  std::vector<double> sum_;
  std::size_t runs_ = 0;
};

/// Adds up complete runs of one cell in the order of the calls. Memory depends on scans only.
class CellAccumulator {
 public:
  CellAccumulator(std::span<const double> times, double level) : times_(times), level_(level) {}

  /// `metrics` measured on `rows`.
  void add(const RunRows& rows, const RunMetrics& metrics);
  /// Fills all that complete runs say; label, failures and missing runs are the caller's.
  CellAnalysis result() const;

 private:
  void add_nees(const RunMetrics& metrics);
  void add_errors(const RunMetrics& metrics);
  void add_weights(const RunRows& rows);
  void add_diversity(const Diversity& diversity);
  void add_effort(const RunRows& rows);
  ErrorSummary errors() const;
  std::optional<WeightSummary> weights() const;
  std::optional<DiversitySummary> diversity() const;

  std::span<const double> times_;
  double level_;
  std::size_t complete_ = 0;
  std::vector<NeesAccumulator> nees_;  ///< leading first
  Moments leading_ = Moments::spread;
  struct {
    SummaryOf position_rmse, position_mse, position_mean, position_variance;
    SummaryOf heading_rmse, heading_mse, heading_mean;
    MeanOverTime position, heading;  ///< squared
  } error_;
  struct {
    SummaryOf ess, resampling_rate;
    MeanOverTime ess_over_time;
  } weights_;
  struct {
    SummaryOf last_resampling, lag, root, final_root;
    MeanOverTime last_resampling_over_time, lag_over_time, root_over_time;
  } diversity_;
  SummaryOf cpu_seconds_, numerical_faults_;
};

}  // namespace montecarta
