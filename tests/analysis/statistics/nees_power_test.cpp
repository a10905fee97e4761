// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_power.hpp"

#include "analysis/statistics/nees_bounds.hpp"
#include "engine/errors.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

// By SciPy's chi2.ppf and chi2.sf (SciPy 1.10).
TEST(RunsNeeded, EqualScipysSearch) {
  EXPECT_EQ(runs_needed({.dimension = 3, .ratio = 1.5}, 0.9), 42u);
  EXPECT_EQ(runs_needed({.dimension = 3, .ratio = 1.2}, 0.9), 209u);
  EXPECT_EQ(runs_needed({.dimension = 2, .ratio = 0.5}, 0.8), 19u);
  EXPECT_EQ(runs_needed({.dimension = 3, .ratio = 1.2, .scans = 100}, 0.9), 35u);
  EXPECT_NEAR(nees_power({.dimension = 3, .ratio = 1.5}, 30), 0.7954307502063781, 1e-12);
}

TEST(RunsNeeded, AreTheFewest) {
  for (const double ratio : {0.3, 0.8, 0.95, 1.05, 1.3, 4.0}) {
    for (const std::uint64_t scans : {1u, 7u, 1000u}) {
      const NeesTest test{.dimension = 3, .ratio = ratio, .level = 0.95, .scans = scans};
      const std::uint64_t runs = runs_needed(test, 0.9);
      EXPECT_GE(nees_power(test, runs), 0.9) << ratio << " " << scans;
      const double before = runs > 1 ? nees_power(test, runs - 1) : 0.0;
      EXPECT_LT(before, 0.9) << ratio << " " << scans;
    }
  }
}

/// Whether the test finds a simulated filter that is off as `test` has it.
bool is_found(const NeesTest& test, std::uint64_t runs, RngStream& draw) {
  const Interval band =
      nees_bounds(runs, test.dimension, level_of_one_scan(test.level, test.scans));
  bool found = false;
  for (std::uint64_t scan = 0; scan < test.scans; ++scan) {
    double sum = 0.0;
    for (std::uint64_t i = 0; i < runs * test.dimension; ++i) {
      const double error = draw.normal();
      sum += test.ratio * error * error;
    }
    const double average = sum / static_cast<double>(runs);
    found = found || average < band.lower || average > band.upper;
  }
  return found;
}

void expect_promise_kept(const NeesTest& test, double power) {
  const std::uint64_t runs = runs_needed(test, power);
  const double promised = nees_power(test, runs);
  RngStream draw({.seed = 5, .purpose = Draw::test});
  constexpr int kStudies = 4000;
  int found = 0;
  for (int i = 0; i < kStudies; ++i) found += is_found(test, runs, draw) ? 1 : 0;
  const double error = std::sqrt(promised * (1.0 - promised) / kStudies);
  EXPECT_NEAR(static_cast<double>(found) / kStudies, promised, 5.0 * error);
}

TEST(NeesPower, IsWhatSimulatedStudiesHave) {
  expect_promise_kept({.dimension = 3, .ratio = 1.5}, 0.9);
  expect_promise_kept({.dimension = 2, .ratio = 0.6}, 0.5);
  expect_promise_kept({.dimension = 3, .ratio = 1.5, .level = 0.9, .scans = 5}, 0.8);
}

TEST(NeesPower, OfFewRunsIsSmall) {
  EXPECT_LT(nees_power({.dimension = 3, .ratio = 1.01}, 1), 0.03);
  EXPECT_DOUBLE_EQ(level_of_one_scan(0.95, 1), 0.95);
  EXPECT_NEAR(std::pow(level_of_one_scan(0.95, 400), 400.0), 0.95, 1e-12);
}

TEST(NeesPower, RefusesWhatIsNoQuestion) {
  for (const double ratio : {1.0, 0.0, -2.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(runs_needed({.ratio = ratio}, 0.9), StudyError) << ratio;
  }
  for (const double power : {0.0, 1.0, -0.5, std::nan("")}) {
    EXPECT_THROW(runs_needed({}, power), StudyError) << power;
  }
  EXPECT_THROW(runs_needed({.dimension = 0}, 0.9), StudyError);
  EXPECT_THROW(runs_needed({.level = 1.0}, 0.9), StudyError);
  EXPECT_THROW(runs_needed({.scans = 0}, 0.9), StudyError);
  EXPECT_THROW(runs_needed({.dimension = 1, .ratio = 1.0000001}, 0.9), StudyError);
}

}  // namespace
}  // namespace montecarta::analysis
