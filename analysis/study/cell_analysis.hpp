// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/nees.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/nees_result.hpp"
#include "analysis/study/score_table.hpp"
#include "analysis/verdict/verdict.hpp"

#include <any>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// A run that ended early.
struct FailedRun {
  std::uint64_t run = 0;
  std::uint32_t step = 0;  ///< step at which the run ended, 0-based
  std::string reason;
};

/// Results of the metrics, at most one of each type: a later result replaces an earlier one.
class Findings {
 public:
  template <class T>
  void put(T result) {
    results_.insert_or_assign(typeid(T), std::move(result));
  }
  /// The result of type T; nullptr if there is none.
  template <class T>
  const T* find() const {
    const auto found = results_.find(typeid(T));
    return found == results_.end() ? nullptr : std::any_cast<T>(&found->second);
  }

 private:
  std::map<std::type_index, std::any> results_;
};

/// The analysis of one cell. Errors, NEES, weights and diversity are those of complete runs only.
struct CellAnalysis {
  std::string label;
  std::string filter;
  std::string long_name;
  std::size_t particles = 0;  ///< number of particles; 0 if it is not a particle filter
  std::vector<std::pair<std::string, std::string>> settings;  ///< resolved settings of the filter
  std::size_t complete = 0;
  std::size_t missing = 0;
  /// Number of runs that were not needed because the cell was precise enough or its verdict was
  /// known.
  std::size_t not_needed = 0;
  /// Number of planned interim analyses of its verdict; 0 if there are none.
  std::size_t analyses_planned = 0;
  std::size_t analyses_made = 0;  ///< number of interim analyses made
  std::vector<FailedRun> failures;
  Verdict verdict;  ///< verdict on the whole error by the leading moments
  /// Moments of the verdict: the first of kMoments that is stored.
  Moments leading = Moments::spread;
  /// NEES by each stored definition of the moments, the leading ones first, each for pose, position
  /// and heading; may be empty.
  std::vector<NeesResult> nees;
  std::vector<std::uint64_t> runs;  ///< numbers of the complete runs, increasing
  ScoreTable scores;                ///< {complete run} scores
  /// {score} interval of the mean over infinitely many runs.
  std::vector<Interval> score_intervals;
  /// Series over the scans: those of all_scan_series() that apply.
  std::vector<Frame::Column> scan_series;
  Findings findings;  ///< all other results, by the type of the metric

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
  /// The NEES of a block by these moments; nullptr if it is not stored.
  const NeesResult* find_nees(ErrorBlock block, Moments moments) const;
  /// Summary of a score over the complete runs; NaN if one of them has no value.
  Summary over_runs(std::string_view score) const;
  /// Summary of a score over the complete runs that have a value: a map without beacons has no
  /// beacon error.
  Spread known_over_runs(std::string_view score) const;
  /// The interval that holds the mean of a score over infinitely many runs.
  Interval interval_of(std::string_view score) const;
  /// {scan} The series of this name; empty if it does not apply.
  const std::vector<double>& over_time(std::string_view series) const;
};

}  // namespace montecarta::analysis
