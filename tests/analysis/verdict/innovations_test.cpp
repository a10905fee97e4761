// SPDX-License-Identifier: BSD-3-Clause
// How often the innovations of an exact Kalman filter are called not white (STATISTICS 9): at most
// 5 %, for few long runs and for many short ones. `MONTECARTA_STUDIES=2000 build/analysis_tests
// --gtest_filter='*SlowWhiteness*'` prints the whole table.
#include "analysis/verdict/innovations.hpp"

#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/nees_bounds.hpp"
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

void add_run(std::uint64_t run, const std::vector<double>& nis,
             const std::vector<std::uint32_t>& dof, InnovationSums& sums) {
  sums.add(run, scan_times(nis.size()), nis, dof);
}

/// Innovations of `dof` components in every scan, each `memory` times the one before, plus noise.
struct MemoryStudy {
  std::size_t runs = 40, scans = kInnovationScans;
  std::uint32_t dof = 4;
  double memory = 0.0;
  double scale = 1.0;  ///< of the NIS

  Innovations innovations(std::uint64_t seed) const {
    InnovationSums sums(scans);
    for (std::uint64_t run = 0; run < runs; ++run) {
      RngStream draw({seed, run, 0, 0, Draw::test});
      std::vector<double> nis, state(dof);
      for (double& one : state) one = draw.normal();
      for (std::size_t s = 0; s < scans; ++s) {
        nis.push_back(0.0);
        for (double& one : state) {
          one = memory * one + std::sqrt(1.0 - memory * memory) * draw.normal();
          nis.back() += scale * one * one;
        }
      }
      add_run(run, nis, std::vector<std::uint32_t>(scans, dof), sums);
    }
    return judged(sums, scans);
  }
};

Innovations innovations_of(double scale, double memory) {
  return MemoryStudy{.memory = memory, .scale = scale}.innovations(23);
}

bool is_called_off(const Innovations& found) {
  return found.verdict.answer != Answer::untested && found.verdict.answer != Answer::consistent &&
         found.verdict.answer != Answer::undecided;
}

TEST(Innovations, OfAConsistentFilterAreWhiteAndOfTheRightSize) {
  const Innovations found = innovations_of(1.0, 0.0);
  EXPECT_NEAR(found.verdict.ratio_estimate(), 1.0,
              5.0 * std::sqrt(2.0 / (4.0 * 40.0 * kInnovationScans)));
  EXPECT_LT(found.verdict.ratio().lower, 1.0);
  EXPECT_GT(found.verdict.ratio().upper, 1.0);
  EXPECT_NEAR(found.share_inside, 0.95, 5.0 * std::sqrt(0.95 * 0.05 / kInnovationScans));
  EXPECT_EQ(found.whiteness(), Whiteness::white);
  EXPECT_LT(found.white_bound[0], 0.04);
  EXPECT_EQ(found.verdict.answer, Answer::consistent);
}

// The squares of an autoregression of memory r go together by r^2, and so nearly do other powers.
TEST(Innovations, ThatRememberAreNotWhite) {
  const Innovations found = innovations_of(1.0, 0.5);
  EXPECT_EQ(found.whiteness(), Whiteness::not_white);
  EXPECT_NEAR(found.autocorrelation[0], 0.25, 0.04);
  EXPECT_NEAR(found.autocorrelation[1], 0.0625, 0.04);
}

TEST(Innovations, ThatAreTooLargeLeaveTheBand) {
  const Innovations found = innovations_of(1.5, 0.0);
  EXPECT_GT(found.verdict.ratio().lower, 1.4);
  EXPECT_LT(found.share_inside, 0.2);
  EXPECT_NEAR(found.autocorrelation[0], 0.0, 0.04);
  EXPECT_EQ(found.whiteness(), Whiteness::white) << "that they are too large is another fault";
  EXPECT_EQ(whiteness_in_words(found), "white, optimistic");
}

/// The innovations of one run.
Innovations innovations_of_run(const std::vector<double>& nis,
                               const std::vector<std::uint32_t>& dof) {
  InnovationSums sums(nis.size());
  add_run(0, nis, dof, sums);
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

// Numbers to the power 2/3 are 1.117, 1.034, -1.473 and -1.051 deviations from their means, by the
// gamma function of SciPy.
TEST(Innovations, OfManyDegreesOfFreedomCountNoMoreThanOfFew) {
  const Innovations found = innovations_of_run({4.0, 12.0, 0.0, 4.0}, {2, 8, 2, 8});
  EXPECT_NEAR(found.autocorrelation[0], 0.271385411111594, 1e-12);
}

// A quarter of no numbers in no runs is no number, and as an integer another one on each processor.
TEST(Innovations, OfNoRunAreTestedAtNoLag) { EXPECT_EQ(LaggedProducts(100).lags(0), 0U); }

TEST(Innovations, OfTwoScansAreNotTested) {
  const Innovations found = innovations_of_run({1.0, 3.0}, {2, 2});
  EXPECT_EQ(found.worst_lag, 0u);
}

// Each step back undoes half of the last one: nothing goes together but neighbours, and those the
// other way round.
TEST(Innovations, ThatAlternateAreNotWhite) {
  InnovationSums sums(kInnovationScans);
  RngStream draw({29, 0, 0, 0, Draw::test});
  for (std::uint64_t run = 0; run < 40; ++run) {
    std::vector<double> nis;
    double before = draw.normal();
    for (std::size_t s = 0; s < kInnovationScans; ++s) {
      const double now = draw.normal();
      nis.push_back(4.0 + now - before);
      before = now;
    }
    add_run(run, nis, std::vector<std::uint32_t>(kInnovationScans, 4), sums);
  }
  const Innovations found = judged(sums, kInnovationScans);
  EXPECT_NEAR(found.autocorrelation[0], -0.5, 0.05);
  EXPECT_LT(*std::ranges::max_element(found.autocorrelation), found.white_bound[19]);
  EXPECT_EQ(found.whiteness(), Whiteness::not_white);
}

TEST(Innovations, ThatAreNoNumbersAreLeftOut) {
  const Innovations found = innovations_of_run({2.0, std::nan(""), 6.0}, {2, 2, 2});
  EXPECT_DOUBLE_EQ(found.verdict.ratio_estimate(), 2.0);
  EXPECT_TRUE(std::isnan(found.average[1]));
}

TEST(Innovations, ThatAreNegativeAreLeftOut) {
  const Innovations found = innovations_of_run({2.0, -1e32, 6.0}, {2, 2, 2});
  EXPECT_DOUBLE_EQ(found.verdict.ratio_estimate(), 2.0);
}

TEST(Innovations, ScansWithoutDetectionsAreLeftOut) {
  InnovationSums sums(3);
  EXPECT_TRUE(sums.empty());
  add_run(0, {0.0, 0.0, 0.0}, {0, 0, 0}, sums);
  EXPECT_TRUE(sums.empty());
  add_run(1, {2.0, 0.0, 6.0}, {2, 0, 2}, sums);
  const Innovations found = judged(sums, 3);
  EXPECT_DOUBLE_EQ(found.verdict.ratio_estimate(), 2.0);
  EXPECT_DOUBLE_EQ(found.average[0], 1.0);
  EXPECT_TRUE(std::isnan(found.average[1]));
  EXPECT_DOUBLE_EQ(found.bounds[2].upper, nees_bounds(2, 1, 0.95).upper);
  EXPECT_DOUBLE_EQ(found.share_inside, 1.0);  // of the two that are tested
}

TEST(Innovations, ThatAreNotWhiteAreJudgedByTheRunsOrNot) {
  MemoryStudy study{.runs = 19, .memory = 0.8};
  const Innovations few = study.innovations(23);
  EXPECT_EQ(few.whiteness(), Whiteness::not_white);
  EXPECT_EQ(few.verdict.answer, Answer::untested);
  EXPECT_NEAR(few.ratio, 1.0, 0.2) << "of all scans together";
  EXPECT_EQ(whiteness_in_words(few), "not white, size not judged");
  EXPECT_EQ(whiteness_in_words(Whiteness::white, Answer::untested), "white, size not judged");
  study.runs = 20;
  const Innovations found = study.innovations(23);
  ASSERT_EQ(found.verdict.families.size(), 1u) << "the laws of stretches and scans do not hold";
  EXPECT_EQ(found.verdict.families[0].family, Family::size);
  // 20 runs of 300 scans of 4 squares, of which 2 / (1 + 0.64) (1 - 0.64) are independent.
  const double error = std::sqrt(2.0 / (20.0 * 300.0 * 4.0) * 1.64 / 0.36);
  EXPECT_NEAR(found.ratio, 1.0, 4.0 * error);
  EXPECT_NEAR(found.verdict.ratio().upper - found.verdict.ratio().lower, 4.2 * error, 1.5 * error);
}

TEST(Innovations, ThatAreNotWhiteAreShownToBeTooLargeByTheRuns) {
  const Innovations found = innovations_of(1.5, 0.8);
  EXPECT_EQ(found.whiteness(), Whiteness::not_white);
  EXPECT_EQ(found.verdict.answer, Answer::optimistic);
}

/// 0.5 to 1.5 in no order.
std::vector<double> thirty_values() {
  RngStream draw({31, 0, 0, 0, Draw::test});
  std::vector<double> nis(30);
  for (double& one : nis) one = 0.5 + draw.uniform();
  return nis;
}

// The first value is that of a filter that begins with a guess; the others have a mean of one.
TEST(Innovations, SayWhatOneOfThemDecides) {
  std::vector<double> nis = thirty_values();
  double others = 0.0;
  for (std::size_t s = 1; s < nis.size(); ++s) others += nis[s] / 29.0;
  nis[0] = 74.0;
  const Innovations found = innovations_of_run(nis, std::vector<std::uint32_t>(30, 1));
  EXPECT_EQ(found.verdict.answer, Answer::optimistic);
  EXPECT_TRUE(found.are_decided_by_largest());
  EXPECT_EQ(found.largest.nis, 74.0);
  EXPECT_EQ(found.largest.dof, 1.0);
  EXPECT_EQ(found.largest.run, 0u);
  EXPECT_EQ(found.largest.time, scan_times(30).front());
  EXPECT_NEAR(found.largest.ratio_without, others, 1e-12);
  EXPECT_FALSE(found.largest.answer_without == Answer::optimistic);
}

// Beside it no other number counts in a double.
TEST(Innovations, LoseNoDigitToAHugeOne) {
  std::vector<double> nis = thirty_values(), dof_of_others;
  const std::vector<std::uint32_t> dof(30, 1);
  std::vector<std::uint32_t> without = dof;
  without[12] = 0;
  const Innovations wanted = innovations_of_run(nis, without);
  nis[12] = 1e60;
  const Innovations found = innovations_of_run(nis, dof);
  EXPECT_EQ(found.largest.ratio_without, wanted.ratio);
  EXPECT_EQ(found.largest.whiteness_without, wanted.whiteness());
  EXPECT_EQ(found.largest.answer_without, wanted.verdict.answer);
}

// 9 of 1 component is rarer than 20 of 10, and 30 of 10 than both.
TEST(Innovations, OfWhichTheLargestIsTheFarthestOut) {
  EXPECT_EQ(innovations_of_run({9.0, 20.0, 1.0}, {1, 10, 1}).largest.nis, 9.0);
  EXPECT_EQ(innovations_of_run({9.0, 30.0, 1.0}, {1, 10, 1}).largest.nis, 30.0);
}

TEST(Innovations, OfARightFilterAreNotDecidedByTheLargest) {
  EXPECT_FALSE(innovations_of(1.0, 0.0).are_decided_by_largest());
  EXPECT_FALSE(innovations_of(1.5, 0.0).are_decided_by_largest());
  EXPECT_FALSE(innovations_of_run({50.0}, {1}).are_decided_by_largest()) << "nothing is left";
}

// The pairs of the largest innovation, which is kept apart, are those of any other.
TEST(Innovations, OfBlocksOfRunsAreThoseOfAllRuns) {
  constexpr std::size_t kScans = 30;
  InnovationSums whole(kScans), first(kScans), second(kScans);
  const std::vector<std::uint32_t> dof(kScans, 2);
  for (std::uint64_t run = 0; run < 8; ++run) {
    RngStream draw({37, run, 0, 0, Draw::test});
    std::vector<double> nis(kScans);
    for (double& one : nis) one = std::pow(draw.normal(), 2) + std::pow(draw.normal(), 2);
    if (run == 2) nis[7] = 60.0;
    if (run == 5) nis[9] = 50.0;
    add_run(run, nis, dof, whole);
    add_run(run, nis, dof, run < 4 ? first : second);
  }
  merge_into(first, second);
  const Innovations found = judged(first, kScans), wanted = judged(whole, kScans);
  EXPECT_EQ(found.largest.nis, 60.0);
  EXPECT_EQ(found.largest.run, 2u);
  EXPECT_NEAR(found.ratio, wanted.ratio, 1e-12);
  EXPECT_NEAR(found.largest.ratio_without, wanted.largest.ratio_without, 1e-12);
  for (std::size_t lag = 0; lag < 7; ++lag) {
    EXPECT_NEAR(found.autocorrelation[lag], wanted.autocorrelation[lag], 1e-12) << lag;
  }
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
    add_run(run, nis, dof, sums);
  }
  return judged(sums, study.scans).whiteness() != Whiteness::not_white;
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

// Innovations of exactly the right size that are not white. One run of 20 or 50 scans seldom shows
// that, and its size is then called off more often than the level: those lines are not compared.
TEST(SlowWhiteness, SizeIsNotCalledOffWhereInnovationsRemember) {
  const std::uint64_t studies = studies_of_a_line(400);
  std::printf("scans  runs  memory  not white [%%]  size off [%%]\n");
  for (const MemoryStudy& study :
       {MemoryStudy{1, 20, 2, 0.8}, MemoryStudy{1, 50, 2, 0.5}, MemoryStudy{1, 100, 2, 0.8},
        MemoryStudy{5, 100, 2, 0.8}, MemoryStudy{20, 100, 2, 0.8}, MemoryStudy{20, 100, 2, 0.95},
        MemoryStudy{50, 20, 2, 0.8}, MemoryStudy{50, 100, 1, 0.8}, MemoryStudy{50, 100, 2, 0.5},
        MemoryStudy{200, 100, 2, 0.95}}) {
    if (!is_table_wanted() && study.runs * study.scans > 5'000) continue;
    std::uint64_t not_white = 0;
    const double rate = share_of_studies(
        studies, [&](std::uint64_t k) { return is_called_off(study.innovations(1 + k)); });
    for (std::uint64_t k = 0; k < studies / 4; ++k) {
      not_white += study.innovations(1 + k).whiteness() == Whiteness::not_white ? 1 : 0;
    }
    const double error = std::sqrt(0.05 * 0.95 / static_cast<double>(studies));
    std::printf("%5zu  %4zu  %.2f  %.1f  %.1f +- %.1f\n", study.scans, study.runs, study.memory,
                400.0 * static_cast<double>(not_white) / static_cast<double>(studies), 100.0 * rate,
                100.0 * error);
    if (study.runs * study.scans < 100) continue;
    EXPECT_LT(rate, 0.05 + 3.0 * error);
  }
}

/// Innovations of a Kalman filter of a random walk with unit steps, whose measurements have unit
/// errors. It believes steps of another variance, and may leave out what is beyond a gate.
struct WalkStudy {
  double believed = 1.0;  ///< variance of a step
  double gate = 0.0;      ///< largest NIS; 0: none
  double bias = 0.0;      ///< of the innovations, in their deviations
  std::size_t runs = 20, scans = 100;

  Innovations innovations(std::uint64_t seed) const {
    InnovationSums sums(scans, 1);
    for (std::uint64_t run = 0; run < runs; ++run) add(seed, run, sums);
    return judged(sums, scans);
  }

 private:
  void add(std::uint64_t seed, std::uint64_t run, InnovationSums& sums) const {
    RngStream draw({seed, run, 0, 1, Draw::test});
    double truth = draw.normal(), mean = 0.0, variance = 1.0;
    std::vector<double> nis(scans), standardised(scans, std::nan(""));
    std::vector<std::uint32_t> dof(scans);
    for (std::size_t s = 0; s < scans; ++s) {
      truth += draw.normal();
      variance += believed;
      const double spread = variance + 1.0;
      const double innovation = truth + draw.normal() - mean + bias * std::sqrt(spread);
      const double squared = innovation * innovation / spread;
      if (gate > 0.0 && squared > gate) continue;
      nis[s] = gate > 0.0 ? chi_squared_before_gate(squared, 1.0, gate) : squared;
      standardised[s] = std::copysign(std::sqrt(nis[s]), innovation);
      dof[s] = 1;
      mean += variance / spread * innovation;
      variance -= variance * variance / spread;
    }
    sums.add(run, scan_times(scans), nis, dof, standardised);
  }
};

// Innovations of the wrong sign that follow each other have squares that hardly do.
TEST(Innovations, AreCorrelatedComponentByComponent) {
  const Innovations right = WalkStudy{}.innovations(41);
  ASSERT_EQ(right.components.size(), 1u);
  EXPECT_TRUE(right.components[0].is_white());
  EXPECT_EQ(right.whiteness(), Whiteness::white);
  const Innovations slow = WalkStudy{.believed = 0.25}.innovations(41);
  EXPECT_EQ(slow.components[0].lag, 1u);
  EXPECT_GT(slow.components[0].correlation, 0.15);
  EXPECT_FALSE(slow.components[0].is_white());
  EXPECT_EQ(slow.whiteness(), Whiteness::not_white);
}

// A gate lets values from 0 to 9 pass; of these 1 has the rank that 1.003... has among all.
TEST(Innovations, BehindAGateHaveTheScaleOfAll) {
  EXPECT_NEAR(chi_squared_before_gate(1.0, 2.0, 9.0),
              -2.0 * std::log(1.0 - (1.0 - std::exp(-0.5)) / (1.0 - std::exp(-4.5))), 1e-12);
  EXPECT_EQ(chi_squared_before_gate(0.0, 2.0, 9.0), 0.0);
  EXPECT_TRUE(std::isfinite(chi_squared_before_gate(9.0, 2.0, 9.0)));
}

// Innovations of a right filter and of one that believes too small steps, behind a gate of three
// deviations and not: how often whiteness and size are called off. `MONTECARTA_STUDIES=2000
// build/analysis_tests --gtest_filter='*SlowGated*'` prints what STATISTICS 9 says.
TEST(SlowGatedInnovations, OfARightFilterAreCalledOffAtTheirLevel) {
  const std::uint64_t studies = studies_of_a_line(200);
  std::printf("believed  gate  not white [%%]  size off [%%]\n");
  for (const WalkStudy& study :
       {WalkStudy{.believed = 1.0, .gate = 0.0}, WalkStudy{.believed = 1.0, .gate = 9.0},
        WalkStudy{.believed = 0.5, .gate = 0.0}, WalkStudy{.believed = 0.5, .gate = 9.0}}) {
    double not_white = 0.0, off = 0.0;
    for (std::uint64_t k = 0; k < studies; ++k) {
      const Innovations found = study.innovations(1 + k);
      not_white += found.whiteness() == Whiteness::not_white ? 1.0 : 0.0;
      off += is_called_off(found) ? 1.0 : 0.0;
    }
    const auto n = static_cast<double>(studies);
    std::printf("%.2f  %.0f  %.1f  %.1f\n", study.believed, study.gate, 100.0 * not_white / n,
                100.0 * off / n);
    if (study.believed == 1.0) {
      EXPECT_LT(not_white / n, 0.05 + share_errors(0.05, studies));
      EXPECT_LT(off / n, 0.05 + share_errors(0.05, studies));
    } else {
      EXPECT_GT(not_white / n, 0.9);
      EXPECT_GT(off / n, 0.9);
    }
  }
}

}  // namespace
}  // namespace montecarta::analysis
