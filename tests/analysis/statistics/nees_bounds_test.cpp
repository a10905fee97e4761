// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_bounds.hpp"

#include "analysis/statistics/interval.hpp"
#include "engine/errors.hpp"
#include "tests/doubles/csv_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace montecarta::analysis {
namespace {

struct GoldenBounds {
  std::uint64_t runs, dimension;
  double level, lower, upper;
};

/// Two-sided intervals of the average NEES by scipy.stats.chi2.ppf, with ten decimals.
std::vector<GoldenBounds> golden_bounds() {
  std::vector<GoldenBounds> all;
  for (const auto& row : engine::read_csv(MONTECARTA_SOURCE_DIR
                                          "/tests/analysis/statistics/golden/nees_bounds.csv")) {
    const auto number = [&](const char* name) { return std::stod(row.at(name)); };
    all.push_back({std::stoull(row.at("runs")), std::stoull(row.at("dimension")), number("level"),
                   number("lower"), number("upper")});
  }
  EXPECT_EQ(all.size(), 108U);
  return all;
}

TEST(NeesBounds, EqualTheGoldenValuesAndRefuseWhatIsNoTest) {
  for (const auto& golden : golden_bounds()) {
    const Interval bounds = nees_bounds(golden.runs, golden.dimension, golden.level);
    EXPECT_NEAR(bounds.lower, golden.lower, 1e-9) << golden.runs << " x " << golden.dimension;
    EXPECT_NEAR(bounds.upper, golden.upper, 1e-9) << golden.runs << " x " << golden.dimension;
  }
  EXPECT_THROW(nees_bounds(0, 3, 0.95), StudyError);
  EXPECT_THROW(nees_bounds(30, 0, 0.95), StudyError);
  for (const double level : {0.0, 1.0, -0.1, 1.5}) {
    EXPECT_THROW(nees_bounds(30, 3, level), StudyError) << level;
  }
}

}  // namespace
}  // namespace montecarta::analysis
