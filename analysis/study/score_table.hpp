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

}  // namespace montecarta::analysis
