// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/measured_run.hpp"
#include "analysis/statistics/sums.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

struct MeasuredRun;

/// The better of two values of a score. For `neither`, `compare` reports in how many runs a value
/// is lower and calls none better.
enum class Better : std::uint8_t { lower, higher, neither };

/// A number of each run, which is averaged over runs and compared run by run.
struct Score {
  const char* name;                  ///< name in files and studies, e.g. "position_rmse"
  const char* units;                 ///< unit in UDUNITS style, "1" if there is none
  const char* words;                 ///< name in tables
  double (*of)(const MeasuredRun&);  ///< value of a run; NaN if the score does not apply
  Better better = Better::lower;
  bool has_ratio = true;  ///< whether a ratio of values is meaningful: their zero is not arbitrary
};

/// A number of every scan of a run, averaged over runs.
struct ScanSeries {
  const char* name;
  const char* units;
  /// {scan} values; empty if the series does not apply. A NaN at a scan of one run makes the mean
  /// NaN.
  std::vector<double> (*of)(const MeasuredRun&);
  bool is_square = false;  ///< whether the root of the mean is shown
};

// All scores and all series, in the order of metrics (all_metrics()).
std::span<const Score> all_scores();

std::span<const ScanSeries> all_scan_series();

/// The score of this name; nullptr if there is none.
const Score* find_score(std::string_view name);

/// The scores of runs in the order of add().
class ScoreTable {
 public:
  ScoreTable();
  void add(const MeasuredRun& run);
  std::size_t runs() const { return runs_; }
  /// Returns whether each score has a value for every run, which a file may not store.
  bool is_whole() const;
  /// {run} The values of a score; `name` must be that of a score.
  const std::vector<double>& column(std::string_view name) const;
  /// Replaces the values {run} of a score.
  void put(std::string_view name, std::vector<double> values);
  static constexpr auto parts() {
    return std::tuple(added(&ScoreTable::runs_), appended(&ScoreTable::columns_));
  }

  /// A score with its value; add() makes a row with these scores only.
  struct Value {
    std::string_view name;
    double value;
  };
  void add(std::span<const Value> values);

 private:
  std::vector<std::vector<double>> columns_;  ///< {score}{run} values
  std::size_t runs_ = 0;
};

/// Index of the score of this name in all_scores().
std::size_t index_of(std::string_view name);

}  // namespace montecarta::analysis
