// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_bounds.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"

#include <string>

namespace montecarta::analysis {

Interval nees_bounds(std::uint64_t runs, std::uint64_t dimension, double level) {
  if (runs == 0 || dimension == 0) {
    throw StudyError(
        "NEES bounds: runs = {}, dimension = {} (an average needs at least one of each): give 1 or "
        "more",
        runs, dimension);
  }
  if (!(level > 0.0 && level < 1.0)) {
    throw StudyError(
        "NEES bounds: level = {} (a probability strictly between 0 and 1): give for instance 0.95",
        std::to_string(level));
  }
  const double n = static_cast<double>(runs);
  const double freedom = n * static_cast<double>(dimension), tail = (1.0 - level) / 2.0;
  return {chi_squared_quantile(tail, freedom) / n, chi_squared_beyond(tail, freedom) / n};
}

}  // namespace montecarta::analysis
