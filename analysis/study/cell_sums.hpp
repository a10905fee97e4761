// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/measured_run.hpp"
#include "analysis/run/run_criteria.hpp"
#include "analysis/run/run_reader.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/score_table.hpp"
#include "engine/core/plan.hpp"
#include "engine/records/result_file.hpp"
#include "engine/threads/parallel.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Averages a number of every scan over runs that have the same scans.
class MeanOverTime {
 public:
  void add(const std::vector<double>& values);
  bool empty() const { return sum_.empty(); }
  std::vector<double> mean() const;
  static constexpr auto parts() {
    return std::tuple(added(&MeanOverTime::sum_, &MeanOverTime::runs_));
  }

 private:
  std::vector<double> sum_;
  double runs_ = 0.0;
};

/// Adds up complete runs of one cell, or of one block, in the order of the calls. Memory depends on
/// scans, and grows by a few numbers with every run.
class CellSums {
 public:
  /// `criteria` must outlive the sums.
  explicit CellSums(const RunCriteria& criteria);

  void add(const MeasuredRun& run);
  /// Adds the sums over the runs that follow; `next` is used up.
  void merge(CellSums&& next);
  /// Writes the sums. Processor times are written as NaN, since they are no function of the study.
  void write(SumWriter& words) const;
  void read(SumReader& words);
  /// The layout of the words: names of scores and series, kinds of numbers.
  std::string layout() const;
  /// Scores of the runs so far.
  const ScoreTable& scores() const { return scores_; }
  void put_cpu_seconds(std::vector<double> of_runs) {
    scores_.put("cpu_seconds", std::move(of_runs));
  }
  /// Fills the results of complete runs; label, failures and missing runs are there already.
  void put(CellAnalysis& cell);

 private:
  void put_series(CellAnalysis& cell) const;

  double level_;
  ScoreTable scores_;
  /// {all_scan_series()} mean over runs of each series. Empty if runs are drives of their own,
  /// since their scans are at other times.
  std::vector<MeanOverTime> over_time_;
  std::vector<std::unique_ptr<MetricSums>> metrics_;  ///< sums of the metrics that have any
};

/// Number of successive complete runs in a block: one thread reads, measures and adds them up, and
/// blocks are merged in their order. So sums have the same bits on any number of threads.
inline constexpr std::size_t kRunsOfABlock = 64;

/// Complete runs of one cell, by their index in the file.
struct CellRuns {
  const RunReader* reader;
  std::span<const std::size_t> runs;
  std::span<const std::uint64_t> numbers;  ///< numbers of these runs in the study
};

/// {cell} The sums over the runs of each cell. The blocks of a group of runs (kRunsOfAGroup) are
/// merged first, and then the groups, whose sums may be stored (stored_sums.hpp). There are never
/// more than two blocks in memory for each thread.
std::vector<CellSums> sums_of(std::span<const CellRuns> cells, const RunCriteria& criteria,
                              const Parallel& parallel);

/// {complete run} A score of each complete run among the first `runs` runs that the file holds of a
/// cell; the file may be unfinished. The result does not depend on the number of threads.
std::vector<double> first_values(const ResultFile& file, const StoredCell& cell, const Score& score,
                                 std::size_t runs, const Parallel& parallel);

/// Returns whether Student's interval reaches less than `wanted` to each side of the mean, and the
/// values have no heavy tail: such values look precise as long as none of the tail was drawn, and
/// stopping then would make the mean too small.
bool is_precise(const std::vector<double>& values, double level, double wanted);

}  // namespace montecarta::analysis
