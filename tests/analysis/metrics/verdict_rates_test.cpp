// SPDX-License-Identifier: BSD-3-Clause
// What the verdict promises, by simulated studies: a table of rates for every number of runs and
// components. `MONTECARTA_STUDIES=4000 build/analysis_tests --gtest_filter='*SlowVerdict*'` prints
// the whole of it from so many studies a line; without the variable 2000 studies of a few lines.
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <tuple>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kRateScans = 60;

/// Three standard errors of a share of so many studies.
double errors_of(double share, std::uint64_t studies) {
  return 3.0 * std::sqrt(share * (1.0 - share) / static_cast<double>(studies));
}

class SlowVerdictRates : public ::testing::TestWithParam<std::tuple<std::uint64_t, std::size_t>> {};

// The part of each line that is promised is 5 %, +- 0.7 % where methods are approximate.
TEST_P(SlowVerdictRates, RejectAConsistentFilterInFivePercentOfStudies) {
  const auto [runs, dimension] = GetParam();
  const bool is_sample = (runs == 20 || runs == 200) && dimension != 2;
  if (!is_sample && !is_table_wanted()) GTEST_SKIP() << kHowToGetTheTable;
  const std::uint64_t studies = studies_of_a_line(2000);
  std::printf("runs  dim  memory  rejected [%%]  above  below  interval holds  stays outside\n");
  for (const double memory : {0.0, 0.7, 0.95, 0.99, 1.0}) {
    const VerdictRates rates =
        verdict_rates({.dimension = dimension, .memory = memory}, runs, kRateScans, studies);
    std::printf("%4d  %3d  %6.2f  %11.2f  %5.2f  %5.2f  %14.2f  %13.2f\n", static_cast<int>(runs),
                static_cast<int>(dimension), memory, 100.0 * rates.rejected(), 100.0 * rates.above,
                100.0 * rates.below, 100.0 * rates.covered, 100.0 * rates.stays);
    std::fflush(stdout);
    EXPECT_NEAR(rates.rejected(), 0.05, 0.007 + errors_of(0.05, studies)) << memory;
    EXPECT_GT(rates.covered, 0.94 - errors_of(0.05, studies)) << memory;
    EXPECT_LT(rates.covered, 0.97 + errors_of(0.04, studies)) << memory;
    EXPECT_LT(rates.stays, 0.0125 + errors_of(0.0125, studies)) << memory;
  }
}

INSTANTIATE_TEST_SUITE_P(OfRunsAndComponents, SlowVerdictRates,
                         ::testing::Combine(::testing::Values(20U, 30U, 40U, 200U, 1000U),
                                            ::testing::Values(1U, 2U, 3U)));

class SlowVerdictAnswers : public ::testing::TestWithParam<std::uint64_t> {};

// A filter that is off is called consistent within 1.1 where its ratio is beyond that, or rejected
// of the wrong side, in at most 2.5 % of studies.
TEST_P(SlowVerdictAnswers, AreWrongSeldom) {
  const std::uint64_t runs = GetParam(), studies = studies_of_a_line(2000) / 4;
  if (runs != 200 && !is_table_wanted()) GTEST_SKIP() << kHowToGetTheTable;
  std::printf("runs  memory  ratio  consistent [%%]  optimistic  conservative  undecided\n");
  for (const double memory : {0.0, 0.95, 1.0}) {
    for (const double ratio : {0.8, 0.9, 1.0, 1.05, 1.1, 1.3}) {
      const VerdictRates rates =
          verdict_rates({.memory = memory, .ratio = ratio}, runs, kRateScans, studies);
      const double consistent = rates.answer(Verdict::consistent);
      const double optimistic = rates.answer(Verdict::optimistic);
      const double conservative = rates.answer(Verdict::conservative);
      std::printf("%4d  %6.2f  %5.2f  %14.1f  %10.1f  %12.1f  %9.1f\n", static_cast<int>(runs),
                  memory, ratio, 100.0 * consistent, 100.0 * optimistic, 100.0 * conservative,
                  100.0 * rates.answer(Verdict::undecided));
      std::fflush(stdout);
      const double most = 0.025 + errors_of(0.025, studies);
      if (ratio < 1.0 / 1.1 || ratio >= 1.1) {
        EXPECT_LT(consistent, most) << memory;
      }
      if (ratio < 1.0) {
        EXPECT_LT(optimistic, most) << memory << ' ' << ratio;
      }
      if (ratio > 1.0) {
        EXPECT_LT(conservative, most) << memory << ' ' << ratio;
      }
      EXPECT_LT(ratio == 1.0 ? optimistic + conservative : 0.0, 0.057 + errors_of(0.05, studies));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfRuns, SlowVerdictAnswers, ::testing::Values(20U, 30U, 40U, 200U, 1000U));

// Some ramps: the NEES is right to half of the run, then grows. That it stays above from a time on
// is said of a time at which it is not yet above in at most 5 % of studies.
TEST(SlowVerdictTimes, AreSeldomTooEarly) {
  constexpr std::size_t kScans = 100;
  const std::uint64_t studies = studies_of_a_line(2000);
  const std::vector<double> times = scan_times(kScans, 0.2);
  const BandWalks walks(kScans);
  for (const std::uint64_t runs : {20U, 200U}) {
    for (const double memory : {0.0, 0.95}) {
      double too_early = 0.0, found = 0.0;
      for (std::uint64_t study = 0; study < studies; ++study) {
        NeesAccumulator sums(ErrorBlock::pose, Moments::spread, kScans);
        for (std::uint64_t run = 0; run < runs; ++run) {
          std::vector<double> nees = draw_nees({.memory = memory}, study, run, kScans);
          for (std::size_t s = 50; s < kScans; ++s)
            nees[s] *= 1.0 + 0.1 * static_cast<double>(s - 50);
          sums.add(nees);
        }
        const auto from = sums.result(times, 0.95, walks).consistency.stays_above_from;
        found += from ? 1.0 : 0.0;
        too_early += from && *from <= times[50] ? 1.0 : 0.0;
      }
      const auto n = static_cast<double>(studies);
      std::printf("%d runs, memory %.2f: found %.1f %%, too early %.2f %%\n",
                  static_cast<int>(runs), memory, 100.0 * found / n, 100.0 * too_early / n);
      EXPECT_GT(found / n, 0.99);
      EXPECT_LT(too_early / n, 0.05 + errors_of(0.05, studies));
    }
  }
}

}  // namespace
}  // namespace montecarta::analysis
