// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/text_of_mean.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/statistics/heavy_tail.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>

namespace montecarta::analysis {

std::string text_of_mean(const std::vector<double>& values, double mean, const Interval& interval,
                         double factor, double level) {
  if (!is_heavy_tailed(values)) {
    return with_interval(factor * mean, {factor * interval.lower, factor * interval.upper});
  }
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  const Interval middle = median_interval(sorted, level);
  return compact(factor * mean) + " (heavy tail), median " +
         with_interval(factor * median_of(values), {factor * middle.lower, factor * middle.upper});
}

}  // namespace montecarta::analysis
