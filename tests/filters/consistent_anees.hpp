// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/number_text.hpp"
#include "analysis/statistics/nees_bounds.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace montecarta::filters {

/// Whether the average NEES of a pose over `runs` runs is one that a consistent filter has, within
/// five standard errors. Says in which direction it is off, and by how much.
inline testing::AssertionResult is_consistent(double anees, std::uint64_t runs) {
  constexpr double kLevel = 1.0 - 5.7e-7;
  const analysis::Interval band = analysis::nees_bounds(runs, 3, kLevel);
  if (anees >= band.lower && anees <= band.upper) return testing::AssertionSuccess();
  return testing::AssertionFailure()
         << (anees < band.lower ? "conservative" : "optimistic") << ": ANEES "
         << analysis::readable(anees) << " where 3 is expected (" << analysis::readable(band.lower)
         << " to " << analysis::readable(band.upper) << " over " << runs << " runs)";
}

}  // namespace montecarta::filters
