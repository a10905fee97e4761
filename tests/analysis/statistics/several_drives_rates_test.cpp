// SPDX-License-Identifier: BSD-3-Clause
// What the verdict on several independent drives promises, by simulated drives of 60 to 300 fixes.
// `MONTECARTA_STUDIES=1000 build/analysis_tests --gtest_filter='*SlowSeveral*'` prints the whole
// table; without the variable a few lines.
#include "analysis/statistics/correlated_average.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <tuple>

namespace montecarta::analysis {
namespace {

/// Errors of variance `ratio` of a drive, half of which forget by exp(-t / memory), half within a
/// fix; `slow` 1: all forget so slowly.
VectorSeries draw_own_drive(std::size_t dimension, double memory, double slow, double ratio,
                            std::uint64_t study, std::uint64_t drive) {
  RngStream draw({.seed = study, .run = drive, .purpose = Draw::test});
  const std::size_t fixes = 60 + 60 * (drive % 5);  // lengths of their own
  const double keep = std::exp(-1.0 / memory), rest = std::sqrt(1.0 - keep * keep);
  VectorSeries errors(dimension, std::vector<double>(fixes));
  for (auto& component : errors) {
    double state = draw.normal();
    for (double& value : component) {
      value = std::sqrt(ratio) * (std::sqrt(slow) * state + std::sqrt(1.0 - slow) * draw.normal());
      state = keep * state + rest * draw.normal();
    }
  }
  return errors;
}

struct RatesOfDrives {
  double above = 0.0, below = 0.0, width = 0.0;
};

RatesOfDrives rates_of_drives(std::size_t drives, std::size_t dimension, double memory, double slow,
                              double ratio, std::uint64_t studies) {
  RatesOfDrives rates;
  const double one = 1.0 / static_cast<double>(studies);
  for (std::uint64_t study = 0; study < studies; ++study) {
    std::vector<VectorSeries> all;
    for (std::size_t drive = 0; drive < drives; ++drive)
      all.push_back(draw_own_drive(dimension, memory, slow, ratio, study, drive));
    const CorrelatedAverage found = correlated_average(all, 0.95);
    rates.above += found.ratio.lower > 1.0 ? one : 0.0;
    rates.below += found.ratio.upper < 1.0 ? one : 0.0;
    rates.width += one * std::log(found.ratio.upper / found.ratio.lower);
  }
  return rates;
}

class SlowSeveralDrives
    : public ::testing::TestWithParam<std::tuple<std::size_t, std::size_t, double>> {};

TEST_P(SlowSeveralDrives, RejectAConsistentFilterInFivePercentOfStudiesAtMost) {
  const auto [drives, dimension, slow] = GetParam();
  const bool is_sample = dimension == 3 && slow == 1.0;
  if (!is_sample && !is_table_wanted()) GTEST_SKIP() << kHowToGetTheTable;
  const std::uint64_t studies = studies_of_a_line(200);
  std::printf("%d drives, %d components, slow part %.1f\nmemory  above [%%]  below  upper/lower\n",
              static_cast<int>(drives), static_cast<int>(dimension), slow);
  for (const double memory : {1.0, 10.0, 100.0, 1e12}) {
    const RatesOfDrives rates = rates_of_drives(drives, dimension, memory, slow, 1.0, studies);
    std::printf("%6.3g  %9.2f  %5.2f  %11.3g\n", memory, 100.0 * rates.above, 100.0 * rates.below,
                std::exp(rates.width));
    std::fflush(stdout);
    const double chance = 3.0 * std::sqrt(0.05 * 0.95 / static_cast<double>(studies));
    EXPECT_LT(rates.above + rates.below, 0.05 + chance) << memory;
  }
}

INSTANTIATE_TEST_SUITE_P(OfDrivesAndComponents, SlowSeveralDrives,
                         ::testing::Combine(::testing::Values(2U, 5U, 20U),
                                            ::testing::Values(1U, 3U),
                                            ::testing::Values(0.5, 1.0)));

// Errors that last for a whole drive make one drive silent, and twenty not.
TEST(SlowSeveralDrivesPower, ManyDrivesFindWhatOneCannot) {
  const RatesOfDrives one = rates_of_drives(1, 3, 1e12, 1.0, 3.0, 100);
  const RatesOfDrives many = rates_of_drives(20, 3, 1e12, 1.0, 3.0, 100);
  EXPECT_LT(one.above, 0.5);
  EXPECT_GT(many.above, 0.95);
}

}  // namespace
}  // namespace montecarta::analysis
