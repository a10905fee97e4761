// SPDX-License-Identifier: BSD-3-Clause
// How often the innovations of an exact Kalman filter are called not white (STATISTICS 9): at most
// 5 %, for few long runs and for many short ones. `MONTECARTA_STUDIES=2000 build/analysis_tests
// --gtest_filter='*SlowWhiteness*'` prints the whole table.
#include "analysis/metrics/innovations.hpp"

#include "engine/random/stream.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kInnovationScans = 300;

Innovations judged(const InnovationSums& sums, std::size_t scans) {
  return sums.result(scan_times(scans), 0.95, 1.1);
}

/// NIS of four degrees of freedom, times `scale`; each innovation is `memory` times the one before,
/// plus noise.
Innovations innovations_of(double scale, double memory, std::uint64_t seed = 23) {
  InnovationSums sums(kInnovationScans);
  for (std::uint64_t run = 0; run < 40; ++run) {
    RngStream draw({seed, run, 0, 0, Draw::test});
    std::vector<double> nis, state(4);
    for (double& one : state) one = draw.normal();
    for (std::size_t s = 0; s < kInnovationScans; ++s) {
      nis.push_back(0.0);
      for (double& one : state) {
        one = memory * one + std::sqrt(1.0 - memory * memory) * draw.normal();
        nis.back() += scale * one * one;
      }
    }
    sums.add(nis, std::vector<std::uint32_t>(kInnovationScans, 4));
  }
  return judged(sums, kInnovationScans);
}

TEST(Innovations, OfAConsistentFilterAreWhiteAndOfTheRightSize) {
  const Innovations found = innovations_of(1.0, 0.0);
  EXPECT_NEAR(found.verdict.ratio_estimate(), 1.0,
              5.0 * std::sqrt(2.0 / (4.0 * 40.0 * kInnovationScans)));
  EXPECT_LT(found.verdict.ratio().lower, 1.0);
  EXPECT_GT(found.verdict.ratio().upper, 1.0);
  EXPECT_NEAR(found.share_inside, 0.95, 5.0 * std::sqrt(0.95 * 0.05 / kInnovationScans));
  EXPECT_TRUE(found.is_white());
  EXPECT_LT(found.white_bound[0], 0.04);
  EXPECT_EQ(found.verdict.answer, Answer::consistent);
}

// The squares of an autoregression of memory r go together by r^2.
TEST(Innovations, ThatRememberAreNotWhite) {
  const Innovations found = innovations_of(1.0, 0.5);
  EXPECT_FALSE(found.is_white());
  EXPECT_NEAR(found.autocorrelation[0], 0.25, 0.04);
  EXPECT_NEAR(found.autocorrelation[1], 0.0625, 0.04);
}

TEST(Innovations, ThatAreTooLargeLeaveTheBand) {
  const Innovations found = innovations_of(1.5, 0.0);
  EXPECT_GT(found.verdict.ratio().lower, 1.4);
  EXPECT_LT(found.share_inside, 0.2);
  EXPECT_NEAR(found.autocorrelation[0], 0.0, 0.04);
  EXPECT_TRUE(found.is_white()) << "that they are too large is another fault";
  EXPECT_EQ(whiteness_in_words(found), "white, optimistic");
}

/// The innovations of one run.
Innovations innovations_of_run(const std::vector<double>& nis,
                               const std::vector<std::uint32_t>& dof) {
  InnovationSums sums(nis.size());
  sums.add(nis, dof);
  return judged(sums, nis.size());
}

// Deviations from their mean are -1/2, 1/2, ...: 7 pairs one scan apart, 6 pairs two scans apart;
// the bound by scipy.stats.norm.
TEST(Innovations, GoTogetherByHand) {
  const Innovations found =
      innovations_of_run({1, 3, 1, 3, 1, 3, 1, 3}, std::vector<std::uint32_t>(8, 2));
  EXPECT_DOUBLE_EQ(found.autocorrelation[0], -1.0);
  EXPECT_DOUBLE_EQ(found.autocorrelation[1], 1.0);
  EXPECT_TRUE(std::isnan(found.autocorrelation[2])) << "a quarter of the scans is two";
  EXPECT_NEAR(found.white_bound[0], 2.236477 / std::sqrt(7.0), 1e-6);
  EXPECT_NEAR(found.white_bound[1], 2.236477 / std::sqrt(6.0), 1e-6);
  EXPECT_EQ(found.worst_lag, 1u);
}

// Deviations of 2 and 4 are one standard deviation each where a NIS has 2 and 8 degrees of freedom.
TEST(Innovations, OfManyDegreesOfFreedomCountNoMoreThanOfFew) {
  const Innovations found = innovations_of_run({4.0, 12.0, 0.0, 4.0}, {2, 8, 2, 8});
  EXPECT_NEAR(found.autocorrelation[0], 1.0 / 3.0, 1e-12);
}

TEST(Innovations, OfTwoScansAreNotTested) {
  const Innovations found = innovations_of_run({1.0, 3.0}, {2, 2});
  EXPECT_EQ(found.worst_lag, 0u);
}

// Each step back undoes half of the last one: nothing goes together but neighbours, and those the
// other way round.
TEST(Innovations, ThatAlternateAreNotWhite) {
  InnovationSums sums(kInnovationScans);
  RngStream draw({29, 0, 0, 0, Draw::test});
  for (int run = 0; run < 40; ++run) {
    std::vector<double> nis;
    double before = draw.normal();
    for (std::size_t s = 0; s < kInnovationScans; ++s) {
      const double now = draw.normal();
      nis.push_back(4.0 + now - before);
      before = now;
    }
    sums.add(nis, std::vector<std::uint32_t>(kInnovationScans, 4));
  }
  const Innovations found = judged(sums, kInnovationScans);
  EXPECT_NEAR(found.autocorrelation[0], -0.5, 0.05);
  EXPECT_LT(*std::ranges::max_element(found.autocorrelation), found.white_bound[19]);
  EXPECT_FALSE(found.is_white());
}

TEST(Innovations, ThatAreNoNumbersAreLeftOut) {
  const Innovations found = innovations_of_run({2.0, std::nan(""), 6.0}, {2, 2, 2});
  EXPECT_DOUBLE_EQ(found.verdict.ratio_estimate(), 2.0);
  EXPECT_TRUE(std::isnan(found.average[1]));
}

TEST(Innovations, ScansWithoutDetectionsAreLeftOut) {
  InnovationSums sums(3);
  EXPECT_TRUE(sums.empty());
  sums.add(std::vector{0.0, 0.0, 0.0}, std::vector<std::uint32_t>{0, 0, 0});
  EXPECT_TRUE(sums.empty());
  sums.add(std::vector{2.0, 0.0, 6.0}, std::vector<std::uint32_t>{2, 0, 2});
  const Innovations found = judged(sums, 3);
  EXPECT_DOUBLE_EQ(found.verdict.ratio_estimate(), 2.0);
  EXPECT_DOUBLE_EQ(found.average[0], 1.0);
  EXPECT_TRUE(std::isnan(found.average[1]));
  EXPECT_DOUBLE_EQ(found.bounds[2].upper, nees_bounds(2, 1, 0.95).upper);
  EXPECT_DOUBLE_EQ(found.share_inside, 1.0);  // of the two that are tested
}

struct WhiteStudy {
  std::size_t scans, runs;
  std::uint32_t dof;
};

bool is_called_white(const WhiteStudy& study, std::uint64_t seed) {
  InnovationSums sums(study.scans);
  const std::vector<std::uint32_t> dof(study.scans, study.dof);
  for (std::uint64_t run = 0; run < study.runs; ++run) {
    RngStream draw({seed, run, 0, 0, Draw::test});
    std::vector<double> nis(study.scans);
    for (double& sum : nis) {
      for (std::uint32_t k = 0; k < study.dof; ++k) sum += std::pow(draw.normal(), 2);
    }
    sums.add(nis, dof);
  }
  return judged(sums, study.scans).is_white();
}

// The squares of one degree of freedom have heavy tails; of a single run 7 % are called not white.
TEST(SlowWhiteness, OfARightFilterIsRejectedAtItsLevel) {
  const std::uint64_t studies = studies_of_a_line(200);
  std::printf("scans  runs  components  not white [%%]\n");
  for (const WhiteStudy& study :
       {WhiteStudy{20, 1, 2}, WhiteStudy{20, 20, 1}, WhiteStudy{20, 20, 2}, WhiteStudy{20, 200, 1},
        WhiteStudy{20, 200, 2}, WhiteStudy{100, 1, 2}, WhiteStudy{100, 20, 1},
        WhiteStudy{100, 20, 2}, WhiteStudy{100, 200, 1}, WhiteStudy{100, 200, 2},
        WhiteStudy{100, 200, 10}, WhiteStudy{1000, 1, 2}, WhiteStudy{1000, 20, 1},
        WhiteStudy{1000, 20, 2}, WhiteStudy{1000, 200, 2}}) {
    if (!is_table_wanted() && study.scans * study.runs > 20'000) continue;
    const double rate =
        share_of_studies(studies, [&](std::uint64_t k) { return !is_called_white(study, 1 + k); });
    const double error = std::sqrt(0.05 * 0.95 / static_cast<double>(studies));
    std::printf("%5zu  %4zu  %10u  %.1f +- %.1f\n", study.scans, study.runs, study.dof,
                100.0 * rate, 100.0 * error);
    EXPECT_LT(rate, 0.06 + 3.0 * error);
  }
}

}  // namespace
}  // namespace montecarta::analysis
