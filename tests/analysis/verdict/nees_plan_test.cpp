// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/nees_plan.hpp"

#include "engine/errors.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>

namespace montecarta::analysis {
namespace {

// Where runs are many all is normal: the average has a deviation of sqrt(2 / (3 x 100 N)), one of
// eleven families leaves 2.84 of it on either side, and 90 % is 1.2816 of them.
TEST(NeesPlan, IsTheNormalLawWhereRunsAreMany) {
  const NeesPlan plan({.dimension = 3, .scans = 100});
  const double to_find = std::pow((2.84 + 1.2816) / std::log(1.02), 2) * 2.0 / 300.0;
  EXPECT_NEAR(static_cast<double>(plan.runs_to_find(1.02, 0.9)) / to_find, 1.0, 0.06);
}

TEST(NeesPlan, NamesTheFewest) {
  for (const double ratio : {0.5, 0.9, 1.2, 3.0}) {
    for (const std::uint64_t scans : {1U, 30U}) {
      const NeesPlan plan({.dimension = 2, .scans = scans});
      const std::uint64_t runs = plan.runs_to_find(ratio, 0.8);
      EXPECT_GE(plan.found(ratio, runs), 0.8) << ratio << ' ' << scans;
      EXPECT_LT(plan.found(ratio, runs - 1), 0.8) << ratio << ' ' << scans;
    }
  }
}

/// Share of studies of a law in which the size is shown to be off.
double share_found(const PlantedLaw& law, std::uint64_t runs, std::size_t scans,
                   std::uint64_t studies) {
  return share_of_studies(studies, [&](std::uint64_t study) {
    return verdict_of(law, study, runs, scans).find(Family::size)->is_rejected;
  });
}

// The promise is kept by the verdict itself: 4 standard errors, and 3 % since the plan knows the
// deviation that the verdict estimates. It may be exceeded: families that reject help each other.
void expect_promise_kept(const PlantedLaw& law, std::size_t scans, double power) {
  const bool is_white = law.memory == Memory::white;
  const NeesPlan plan({.dimension = law.dimension, .scans = is_white ? scans : 1});
  const std::uint64_t runs = plan.runs_to_find(law.ratio, power);
  const std::uint64_t studies = studies_of_a_line(200);
  const double found = share_found(law, runs, scans, studies);
  std::printf("%zu components, %s, ratio %.2f: %llu runs, promised %.1f %%, found %.1f %%\n",
              law.dimension, is_white ? "independent scans" : "constant", law.ratio,
              static_cast<unsigned long long>(runs), 100.0 * plan.found(law.ratio, runs),
              100.0 * found);
  EXPECT_GE(found, plan.found(law.ratio, runs) - 0.03 - share_errors(power, studies, 4.0));
}

// MONTECARTA_STUDIES=2000 gives the table of STATISTICS 17.
TEST(NeesPlan, SlowIsWhatSimulatedStudiesHave) {
  for (const std::size_t dimension : {1u, 2u, 3u, 6u}) {
    expect_promise_kept({.dimension = dimension, .memory = Memory::constant, .ratio = 1.5}, 2, 0.9);
    expect_promise_kept({.dimension = dimension, .memory = Memory::constant, .ratio = 0.6}, 2, 0.9);
    expect_promise_kept({.dimension = dimension, .ratio = 1.1}, 20, 0.9);
  }
}

// No double holds the tail that the test of three runs of one component asks for.
TEST(NeesPlan, AnswersForEveryDimension) {
  for (const std::size_t dimension : {1u, 2u, 3u, 6u, 1000u}) {
    const NeesPlan plan({.dimension = dimension});
    EXPECT_EQ(plan.found(3.0, 3) >= 0.0, true) << dimension;
    std::uint64_t more = plan.runs_to_find(1.05, 0.9);
    for (const double ratio : {1.2, 1.5, 3.0}) {
      const std::uint64_t runs = plan.runs_to_find(ratio, 0.9);
      EXPECT_LE(runs, more) << dimension << ' ' << ratio;
      more = runs;
    }
    EXPECT_GE(plan.runs_to_find(0.8, 0.9), plan.runs_to_find(0.3, 0.9)) << dimension;
  }
}

TEST(NeesPlan, SlowShowsAConsistentFilterAtLeastAsOftenAsItSays) {
  const NeesPlan plan({.dimension = 3, .scans = 20});
  const std::uint64_t runs = plan.runs_to_show(1.2, 0.8);
  const double shown = share_of_studies(100, [&](std::uint64_t study) {
    return verdict_of(PlantedLaw{}, study, runs, 20, 1.2).answer == Answer::consistent;
  });
  EXPECT_GE(shown, 0.8 - share_errors(0.8, 100));
}

TEST(NeesPlan, RefusesWhatIsNoQuestion) {
  const NeesPlan plan({});
  for (const double ratio : {1.0, 0.0, -2.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(plan.runs_to_find(ratio, 0.9), StudyError) << ratio;
  }
  for (const double power : {0.0, 1.0, -0.5, std::nan("")}) {
    EXPECT_THROW(plan.runs_to_find(1.5, power), StudyError) << power;
  }
  EXPECT_THROW(plan.runs_to_show(1.0, 0.9), StudyError);
  EXPECT_THROW(NeesPlan({.dimension = 0}), StudyError);
  EXPECT_THROW(NeesPlan({.level = 1.0}), StudyError);
  EXPECT_THROW(NeesPlan({.scans = 0}), StudyError);
  EXPECT_THROW(NeesPlan({.scans = kMostPlannedScans + 1}), StudyError);
  EXPECT_THROW(plan.runs_to_find(1.0000001, 0.9), StudyError);
}

}  // namespace
}  // namespace montecarta::analysis
