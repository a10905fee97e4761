// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/score_intervals.hpp"

#include "analysis/metrics/bootstrap.hpp"

namespace montecarta {

void put_score_intervals(CellAnalysis& cell, double level) {
  std::vector<std::vector<double>> columns;
  for (const ScoreName& name : score_names()) {
    auto& column = columns.emplace_back();
    for (const RunScores& run : cell.scores) column.push_back(run.*name.value);
  }
  const std::vector<Interval> intervals = bootstrap_means(columns, level);
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    cell.lower.*score_names()[k].value = intervals[k].lower;
    cell.upper.*score_names()[k].value = intervals[k].upper;
  }
}

}  // namespace montecarta
