// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/exit_bootstrap.hpp"
#include "analysis/metrics/lineage_sums.hpp"
#include "analysis/metrics/nees_accumulator.hpp"
#include "analysis/metrics/run_metrics.hpp"
#include "analysis/metrics/run_rows.hpp"
#include "analysis/statistics/whole_run_band.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace montecarta {

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
  /// `times` [s] of the scans and `walks` of as many must outlive it.
  CellAccumulator(std::span<const double> times, double level, const BandWalks& walks);

  /// `metrics` measured on `rows`.
  void add(const RunRows& rows, const RunMetrics& metrics);
  /// {run} What a run says by itself.
  const std::vector<RunScores>& scores() const { return scores_; }
  /// Fills all that complete runs say; label, failures and missing runs are the caller's.
  CellAnalysis result();

 private:
  void add_nees(const RunMetrics& metrics);
  void add_leading(const RunMetrics& metrics);
  void add_over_time(const RunRows& rows, const RunMetrics& metrics);
  Summary over_runs(double RunScores::*score) const;
  ErrorSummary errors() const;
  std::optional<WeightSummary> weights() const;
  std::optional<DiversitySummary> diversity() const;
  std::optional<AssociationSummary> association() const;
  void put_leading(CellAnalysis& cell);

  std::span<const double> times_;
  double level_;
  const BandWalks* walks_;
  double run_bound_;  ///< upper end of the band of a single run's NEES
  std::size_t complete_ = 0;
  std::vector<NeesAccumulator> nees_;  ///< leading first
  Moments leading_ = Moments::spread;
  std::vector<RunScores> scores_;  ///< {run}
  std::vector<double> run_exits_;  ///< [s] {run}
  ExitBootstrap exits_;
  CredibilitySamples credibility_;
  ErrorMoments moments_;
  InnovationSums innovations_;
  LineageSums lineages_;
  MeanOverTime squared_position_, squared_heading_, ess_, last_resampling_, lag_, root_, map_size_;
};

}  // namespace montecarta
