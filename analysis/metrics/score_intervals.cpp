// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/score_intervals.hpp"

#include "analysis/statistics/bootstrap.hpp"

namespace montecarta {

void put_score_intervals(CellAnalysis& cell, double level) {
  std::vector<std::vector<double>> columns;
  for (const ScoreName& name : score_names()) {
    auto& column = columns.emplace_back();
    for (const RunScores& run : cell.scores) column.push_back(run.*name.value);
  }
  for (const NeesResult& nees : cell.nees) columns.push_back(nees.series.run_averages);
  const std::vector<Interval> intervals = bootstrap_means(columns, level);
  const std::size_t scores = score_names().size();
  for (std::size_t k = 0; k < cell.nees.size(); ++k) {
    cell.nees[k].consistency.average_interval = intervals[scores + k];
  }
  for (std::size_t k = 0; k < scores; ++k) {
    cell.lower.*score_names()[k].value = intervals[k].lower;
    cell.upper.*score_names()[k].value = intervals[k].upper;
  }
}

}  // namespace montecarta
