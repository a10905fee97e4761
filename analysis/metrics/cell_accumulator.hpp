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

/// Adds up complete runs of one cell in the order of the calls. Memory depends on scans, and grows
/// by a few numbers with every run.
class CellAccumulator {
 public:
  CellAccumulator(std::span<const double> times, double level) : times_(times), level_(level) {}

  /// `metrics` measured on `rows`.
  void add(const RunRows& rows, const RunMetrics& metrics);
  /// Fills all that complete runs say; label, failures and missing runs are the caller's.
  CellAnalysis result() const;

 private:
  void add_nees(const RunMetrics& metrics);
  void add_over_time(const RunRows& rows, const RunMetrics& metrics);
  Summary over_runs(double RunScores::*score) const;
  ErrorSummary errors() const;
  std::optional<WeightSummary> weights() const;
  std::optional<DiversitySummary> diversity() const;
  std::optional<AssociationSummary> association() const;

  std::span<const double> times_;
  double level_;
  std::size_t complete_ = 0;
  std::vector<NeesAccumulator> nees_;  ///< leading first
  Moments leading_ = Moments::spread;
  std::vector<RunScores> scores_;  ///< {run}
  MeanOverTime squared_position_, squared_heading_, ess_, last_resampling_, lag_, root_, map_size_;
};

}  // namespace montecarta
