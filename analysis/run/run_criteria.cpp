// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/run_criteria.hpp"

#include "analysis/statistics/error_spending.hpp"

namespace montecarta::analysis {

double RunCriteria::verdict_level(std::uint64_t runs) const {
  return level_of_look(level, looks, runs);
}

}  // namespace montecarta::analysis
