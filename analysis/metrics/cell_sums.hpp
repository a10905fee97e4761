// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_reader.hpp"
#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/score.hpp"
#include "engine/records/result_file.hpp"
#include "engine/threads/parallel.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Adds up a number of every scan over runs of the same scans.
class MeanOverTime {
 public:
  void add(const std::vector<double>& values);
  bool empty() const { return sum_.empty(); }
  std::vector<double> mean() const;

 private:
  std::vector<double> sum_;
  double runs_ = 0.0;
};

/// Adds up complete runs of one cell in the order of the calls. Memory depends on scans, and grows
/// by a few numbers with every run.
class CellSums {
 public:
  /// `criteria` must outlive it.
  explicit CellSums(const RunCriteria& criteria);

  /// Metrics are added up at once, each by one thread in the order of the runs.
  void add(std::span<const MeasuredRun> runs, const Parallel& parallel = Parallel::serial());
  /// Of the runs so far.
  const ScoreTable& scores() const { return scores_; }
  /// Fills all that complete runs say; label, failures and missing runs are there already.
  void put(CellAnalysis& cell);

 private:
  void add_to_series(const MeasuredRun& run);
  void put_series(CellAnalysis& cell) const;

  double level_;
  ScoreTable scores_;
  /// Of all_scan_series(); none where runs are drives of their own, scanned at other times.
  std::vector<MeanOverTime> over_time_;
  std::vector<std::unique_ptr<MetricSums>> metrics_;  ///< those that have any
};

/// Measures `runs` of one cell, some at once, and adds them up in their order. `cells` is how many
/// cells are added up at once: together they hold about four runs for each thread.
void add_runs(const RunReader& reader, std::span<const std::size_t> runs, std::size_t particles,
              const RunCriteria& criteria, const Parallel& parallel, std::size_t cells,
              CellSums& sums);

/// A score of each complete run among the first `runs` that a file holds of a cell, in their order;
/// the file may be unfinished. The same for any number of threads.
std::vector<double> first_values(const ResultFile& file, const StoredCell& cell, const Score& score,
                                 std::size_t runs, const Parallel& parallel);

/// Half the width of the interval in which the mean over infinitely many runs lies with probability
/// `level`, by Student's t; infinite of fewer than two values, NaN where one is.
double half_width(const std::vector<double>& values, double level);

/// Whether that is below `wanted`, and the values are such that it can be believed: values with a
/// heavy tail look precise as long as none of the tail was drawn, and stopping then would make the
/// mean too small.
bool is_precise(const std::vector<double>& values, double level, double wanted);

}  // namespace montecarta::analysis
