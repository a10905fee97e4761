// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/first_values.hpp"

#include "analysis/metrics/cell_sums.hpp"
#include "analysis/statistics/means.hpp"
#include "analysis/statistics/spread.hpp"

#include <limits>

namespace montecarta::analysis {

std::vector<double> first_values(const ResultFile& file, const StoredCell& cell, const Score& score,
                                 std::size_t runs, const Parallel& parallel) {
  const std::vector<RunStatus> status = file.status(cell);
  std::vector<std::size_t> complete;
  for (std::size_t i = 0; i < runs; ++i) {
    if (status[i] == RunStatus::complete) complete.push_back(i);
  }
  const RunCriteria criteria = criteria_of(file, 0.95);
  std::vector<MeasuredRun> slots = slots_for(parallel);
  CellSums sums(criteria);
  add_runs(RunReader(file, cell), complete, cell.particles, criteria, parallel, slots, sums);
  return sums.scores().column(score.name);
}

double half_width(const std::vector<double>& values, double level) {
  if (values.size() < 2) return std::numeric_limits<double>::infinity();
  SummaryOf sums;
  for (const double value : values) sums.add(value);
  return t_quantile(values.size(), level) * sums.result().standard_error();
}

bool is_precise(const std::vector<double>& values, double level, double wanted) {
  return half_width(values, level) < wanted && !is_heavy_tailed(values);
}

}  // namespace montecarta::analysis
