// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/nees.hpp"
#include "analysis/output/frame.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/verdict.hpp"

#include <any>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

namespace montecarta::analysis {

struct MeasuredRun;

/// Which of two values of a score is better. For `neither`, `compare` says in how many runs a value
/// is lower and calls none better.
enum class Better : std::uint8_t { lower, higher, neither };

/// A number of each run, which is averaged over runs and compared run by run.
struct Score {
  const char* name;                  ///< as files and studies call it, e.g. "position_rmse"
  const char* units;                 ///< UDUNITS style, "1" where there is none
  const char* words;                 ///< for tables
  double (*of)(const MeasuredRun&);  ///< NaN where it does not apply
  Better better = Better::lower;
  bool has_ratio = true;  ///< whether two values may be divided: their zero is not arbitrary
};

/// A number of every scan of a run, averaged over runs.
struct ScanSeries {
  const char* name;
  const char* units;
  /// {scan} Empty if it does not apply; NaN at a scan of one run leaves a gap in the mean.
  std::vector<double> (*of)(const MeasuredRun&);
  bool is_square = false;  ///< the root of the mean is shown
};

// All of them, in the order of metrics (all_metrics()).
std::span<const Score> all_scores();
std::span<const ScanSeries> all_scan_series();

/// nullptr where no score has this name.
const Score* find_score(std::string_view name);

/// The scores of runs in the order of add().
class ScoreTable {
 public:
  ScoreTable();
  void add(const MeasuredRun& run);
  std::size_t runs() const { return runs_; }
  /// Whether each score has a value for every run, which a file may not keep.
  bool is_whole() const;
  /// {run}; `name` must be that of a score.
  const std::vector<double>& column(std::string_view name) const;
  /// Replaces the values of a score, one a run.
  void put(std::string_view name, std::vector<double> values);
  static constexpr auto parts() {
    return std::tuple(added(&ScoreTable::runs_), appended(&ScoreTable::columns_));
  }

  /// A row that has these scores only.
  struct Value {
    std::string_view name;
    double value;
  };
  void add(std::span<const Value> values);

 private:
  std::vector<std::vector<double>> columns_;  ///< {score}{run}
  std::size_t runs_ = 0;
};

/// Place of the score of this name among all_scores().
std::size_t index_of(std::string_view name);

/// NEES of one definition of error and covariance over scans and runs.
struct NeesSeries {
  std::size_t dimension = 0;
  std::vector<double> average;       ///< {scan} over valid runs; NaN where there is none
  std::vector<std::uint32_t> runs;   ///< {scan} valid: complete, with a finite NEES
  std::vector<Interval> bounds;      ///< {scan} of the average of a consistent filter at that scan
  std::vector<double> run_averages;  ///< {run} over its scans, of runs that have any NEES
  std::uint64_t samples = 0;         ///< scans x complete runs
  std::uint64_t lower_rank = 0;      ///< of them: judged in the range of a singular covariance
  std::uint64_t unusable = 0;  ///< of them: error or covariance is not finite, or the covariance
                               ///< not positive semidefinite; left out of the average
  std::uint64_t too_few = 0;   ///< of them: too few effective draws to be judged, left out as well
  std::uint64_t unjudged_runs = 0;  ///< complete runs without a NEES at any scan, left out as well
};

/// A NEES series in a few numbers.
struct NeesResult {
  ErrorBlock block = ErrorBlock::pose;
  Moments moments = Moments::spread;
  NeesSeries series;
  double mean = kNaN;              ///< of series.run_averages
  Interval average_interval = {};  ///< of the mean over infinitely many runs (bootstrap)
  double share_above = 0.0;        ///< of scans with a valid run: above the bounds of a scan
  double share_below = 0.0;        ///< below them

  double share_inside() const { return 1.0 - share_above - share_below; }
  bool is_tested() const { return !std::isnan(mean); }
};

/// A run that ended early.
struct FailedRun {
  std::uint64_t run = 0;
  std::uint32_t step = 0;  ///< 0-based
  std::string reason;
};

/// Results of the metrics, at most one of each type: a later result replaces an earlier one.
class Findings {
 public:
  template <class T>
  void put(T result) {
    results_.insert_or_assign(typeid(T), std::move(result));
  }
  /// nullptr where there is none.
  template <class T>
  const T* find() const {
    const auto found = results_.find(typeid(T));
    return found == results_.end() ? nullptr : std::any_cast<T>(&found->second);
  }

 private:
  std::map<std::type_index, std::any> results_;
};

/// The analysis of one cell. Errors, NEES, weights and diversity are over complete runs only.
struct CellAnalysis {
  std::string label;
  std::string filter;
  std::string long_name;
  std::size_t particles = 0;  ///< 0: not a particle filter
  std::size_t complete = 0;
  std::size_t missing = 0;
  std::size_t spared = 0;         ///< not made: the cell was precise enough, or its verdict known
  std::size_t looks_planned = 0;  ///< at its verdict, where cells stop by it, else 0
  std::size_t looks_made = 0;     ///< of them
  std::vector<FailedRun> failures;
  Verdict verdict;                         ///< on the whole error by the leading moments
  Moments leading = Moments::spread;       ///< of the verdict: the first of kMoments there is
  std::vector<NeesResult> nees;            ///< leading first; pose, position, heading; may be empty
  std::vector<std::uint64_t> runs;         ///< numbers of the complete runs, increasing
  ScoreTable scores;                       ///< of each of them
  std::vector<Interval> score_intervals;   ///< {score} of the mean over infinitely many runs
  std::vector<Frame::Column> scan_series;  ///< of all_scan_series() those that apply
  Findings findings;                       ///< all else, by the metric's own type

  /// The result of a metric; nullptr where it does not apply.
  template <class T>
  const T* find() const {
    return findings.find<T>();
  }
  /// The result of a metric; T{} where it does not apply.
  template <class T>
  const T& get() const {
    static const T none{};
    const T* found = find<T>();
    return found != nullptr ? *found : none;
  }
  /// nullptr where it is not stored.
  const NeesResult* find_nees(ErrorBlock block, Moments moments) const;
  /// A score over the complete runs; NaN if one of them has no value.
  Summary over_runs(std::string_view score) const;
  /// A score over the complete runs that have a value: a map without beacons has no beacon error.
  Spread known_over_runs(std::string_view score) const;
  /// The interval that holds the mean of a score over infinitely many runs.
  Interval interval_of(std::string_view score) const;
  /// {scan} of this name; empty where it does not apply.
  const std::vector<double>& over_time(std::string_view series) const;
};

/// Places (left, right) of the numbers that two increasing lists share.
std::vector<std::pair<std::size_t, std::size_t>> common_places(
    std::span<const std::uint64_t> left, std::span<const std::uint64_t> right);

/// Runs of two cells in the same worlds. A cell has no value in a run that failed or that has no
/// finite score; it then loses to a cell that has a value.
struct PairedRuns {
  std::vector<double> left, right;  ///< of each run in which both have a value, in order
  std::size_t left_alone = 0;       ///< runs in which only `left` has a value: it wins
  std::size_t right_alone = 0;
  std::size_t neither = 0;   ///< ended in both cells, without a value in either: tied
  std::size_t unpaired = 0;  ///< ended in one of the two cells only

  std::size_t ended() const { return left.size() + left_alone + right_alone + neither; }
  /// Left minus right, of each run in which both have a value.
  std::vector<double> differences() const;
};

PairedRuns paired_runs(const CellAnalysis& left, const CellAnalysis& right, const Score& score);

/// Whether any run of the cell has a finite value.
bool has_score(const CellAnalysis& cell, const Score& score);

/// Whether the score applies to the cell: whether a run has a finite value, or all runs failed.
/// EKF-SLAM, for instance, has no effective particles.
bool is_judged_by(const CellAnalysis& cell, const Score& score);

}  // namespace montecarta::analysis
