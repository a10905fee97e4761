// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/cell_analysis.hpp"

#include "analysis/study/nees_result.hpp"
#include "analysis/study/score_table.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {

const NeesResult* CellAnalysis::find_nees(ErrorBlock block, Moments moments) const {
  const auto found = std::ranges::find_if(nees, [&](const NeesResult& candidate) {
    return candidate.block == block && candidate.moments == moments;
  });
  return found == nees.end() ? nullptr : &*found;
}

Summary CellAnalysis::over_runs(std::string_view score) const {
  return summary_of(scores.column(score));
}

Spread CellAnalysis::known_over_runs(std::string_view score) const {
  std::vector<double> values;
  for (const double value : scores.column(score)) {
    if (!std::isnan(value)) values.push_back(value);
  }
  return spread_of(values);
}

Interval CellAnalysis::interval_of(std::string_view score) const {
  return score_intervals.empty() ? Interval{kNaN, kNaN} : score_intervals[index_of(score)];
}

const std::vector<double>& CellAnalysis::over_time(std::string_view series) const {
  static const std::vector<double> none;
  const auto found = std::ranges::find(scan_series, series, &Frame::Column::name);
  return found == scan_series.end() ? none : found->numbers;
}

}  // namespace montecarta::analysis
