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

}  // namespace montecarta::analysis
