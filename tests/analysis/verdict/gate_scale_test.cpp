// SPDX-License-Identifier: BSD-3-Clause
// The size of innovations behind a gate (STATISTICS (9.4)). `MONTECARTA_STUDIES=1000
// build/analysis_tests --gtest_filter='*SlowGateScale*'` prints the table of chapter 9.
#include "analysis/verdict/gate_scale.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

// Of two components the law is exponential: q' = -2 log(1 - F(q) / F(9)). By SciPy, see STATISTICS.
TEST(GateScale, ShowsLessThanTheFactor) {
  const GateScale scale({{2714.0, 2.0, 9.0}});
  EXPECT_NEAR(scale.shown(1.0), 1.0, 1e-4);
  EXPECT_NEAR(scale.shown(2.0), 1.610, 2e-3);
  EXPECT_NEAR(scale.shown(0.5), 0.511, 2e-3);
  EXPECT_NEAR(GateScale({{1.0, 1.0, 9.0}}).shown(1.5), 1.411, 2e-3);
}

TEST(GateScale, FindsTheFactorThatIsShown) {
  const GateScale scale({{2000.0, 2.0, 9.0}, {700.0, 3.0, 11.345}});
  EXPECT_EQ(scale.factor_of(1.0), 1.0) << "a right filter stays right";
  for (const double factor : {0.02, 0.5, 0.9, 1.1, 1.37, 2.0, 10.0, 100.0}) {
    EXPECT_NEAR(scale.factor_of(scale.shown(factor)), factor, 2e-3 * factor);
  }
  EXPECT_EQ(scale.factor_of(50.0), GateScale::kMostFactor) << "no factor shows so much";
  EXPECT_TRUE(std::isinf(scale.factor_of(Interval{0.9, 50.0}).upper));
  EXPECT_TRUE(std::isnan(scale.factor_of(Interval{kNaN, kNaN}).upper));
}

TEST(GateScale, ThatLeavesNothingOutChangesNothing) {
  const GateScale scale({{100.0, 1.0, 5000.0}});
  for (const double ratio : {0.3, 1.0, 1.7, 5.0}) EXPECT_NEAR(scale.factor_of(ratio), ratio, 2e-3);
  EXPECT_NEAR(chi_squared_before_gate(4000.0, 1.0, 5000.0), 4000.0, 1e-9) << "its tail underflows";
}

TEST(GateScale, IsReadFromASettingOfACell) {
  const auto scale = gate_scale_of("2000 rows of 2 up to 9, 700 rows of 3 up to 11.345");
  ASSERT_TRUE(scale.has_value());
  EXPECT_EQ(scale->shown(2.0), GateScale({{2000.0, 2.0, 9.0}, {700.0, 3.0, 11.345}}).shown(2.0));
  for (const char* damaged : {"", "9", "2000 rows of 2", "-1 rows of 2 up to 9",
                              "10 rows of 1e9 up to 9", "10 rows of 2 up to nan"}) {
    EXPECT_FALSE(gate_scale_of(damaged).has_value()) << damaged;
  }
}

// The likelihood of what passed, by hand: mean of values up to 9 of two components and scale 2.
TEST(GateScale, AgreesWithTheLikelihoodOfWhatPassed) {
  const double F = 1.0 - std::exp(-9.0 / 4.0);
  const double mean = 4.0 * (1.0 - (1.0 + 9.0 / 4.0) * std::exp(-9.0 / 4.0)) / F;
  EXPECT_NEAR(chi_squared_scale_up_to(9.0, 2.0, mean), 2.0, 1e-6);
  EXPECT_EQ(chi_squared_scale_up_to(9.0, 2.0, 4.5), 9000.0) << "uniform up to the limit";
}

/// White innovations whose covariance is too small by `factor`, of which a gate of `limit` lets
/// some pass.
struct GatedStudy {
  std::size_t runs, scans, dimension;
  double limit, factor;
  double factor_of_first = factor;  ///< of the first component

  Verdict verdict(std::uint64_t seed, const GateScale& scale, double level) const {
    WholeError sums(dimension, scans);
    for (std::uint64_t run = 0; run < runs; ++run) {
      RngStream draw({seed, run, 0, 3, Draw::test});
      WhitenedRun errors{dimension, std::vector<double>(scans * dimension, kNaN), {}};
      errors.number = run;
      std::vector<double> nis(scans, kNaN);
      for (std::size_t s = 0; s < scans; ++s) {
        double squared = 0.0;
        std::vector<double> one(dimension);
        for (std::size_t k = 0; k < dimension; ++k) {
          one[k] = std::sqrt(k == 0 ? factor_of_first : factor) * draw.normal();
          squared += one[k] * one[k];
        }
        if (squared > limit) continue;
        nis[s] = chi_squared_before_gate(squared, static_cast<double>(dimension), limit);
        for (std::size_t k = 0; k < dimension; ++k)
          errors.whitened[s * dimension + k] = one[k] * std::sqrt(nis[s] / squared);
      }
      errors.standardised = errors.whitened;
      sums.add(errors, nis);
    }
    const std::vector<double> times = scan_times(scans);
    const std::vector<std::string> names = letters(dimension);
    const ErrorNames all{names, times};
    auto families = sums.white_families(level, all, &scale);
    if (families.empty()) families = sums.families(level, all, &scale);
    return judge(std::move(families), level, kUsualMargin, runs, sums.beside_tests(all));
  }
};

// The gate lets pass less of the right component where the other one is too large, and more where
// it is too small.
TEST(GateScale, AccusesNoRightComponentBesideAWrongOne) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const GatedStudy large{400, 60, 2, 9.0, 1.0, 9.0}, small{400, 60, 2, 4.0, 1.0, 0.05};
    const Verdict above = large.verdict(seed, GateScale({{1.0, 2.0, 9.0}}), 0.95);
    EXPECT_EQ(above.answer, Answer::optimistic) << seed;
    EXPECT_GT(above.ratio().lower, 1.5) << "one factor of both";
    const Verdict below = small.verdict(seed, GateScale({{1.0, 2.0, 4.0}}), 0.95);
    EXPECT_EQ(below.answer, Answer::conservative) << seed;
    EXPECT_LT(below.ratio().upper, 0.7);
  }
  const Verdict one =
      GatedStudy{1, 1000, 2, 9.0, 1.0}.verdict(1, GateScale({{1.0, 2.0, 9.0}}), 0.95);
  EXPECT_NE(one.find(Family::size), nullptr);
  EXPECT_EQ(one.find(Family::component), nullptr) << "also of one white drive";
}

TEST(SlowGateScale, HoldsTheFactorAndSparesARightFilter) {
  const std::uint64_t studies = studies_of_a_line(100);
  std::printf("runs  scans  d  gate  factor  mean  held [%%]  accused [%%]  consistent [%%]\n");
  std::vector<GatedStudy> lines;
  for (const auto& [runs, scans] : {std::pair<std::size_t, std::size_t>{1, 1000}, {20, 100}}) {
    for (const auto& [d, limit] : {std::pair<std::size_t, double>{1, 9.0}, {2, 9.0}, {2, 5.99}}) {
      for (const double factor : {1.0, 1.1, 1.2, 1.5, 2.0, 1.0 / 1.5})
        lines.push_back({runs, scans, d, limit, factor});
    }
  }
  lines = tested_lines(std::move(lines), [](const GatedStudy& one) {
    return one.dimension == 2 && one.limit == 9.0;
  });
  for (const GatedStudy& one : lines) {
    const GateScale scale({{1.0, static_cast<double>(one.dimension), one.limit}});
    double held = 0.0, accused = 0.0, consistent = 0.0, sum = 0.0;
    for (std::uint64_t k = 0; k < studies; ++k) {
      const Verdict found = one.verdict(1 + k, scale, 0.95);
      const Interval ratio = found.ratio();
      held += ratio.lower <= one.factor && one.factor <= ratio.upper ? 1.0 : 0.0;
      accused += is_rejected(found) ? 1.0 : 0.0;
      consistent += found.answer == Answer::consistent ? 1.0 : 0.0;
      sum += std::log(found.ratio_estimate());
    }
    const auto n = static_cast<double>(studies);
    std::printf("%2zu  %4zu  %zu  %.2f  %.3f  %.3f  %.1f  %.1f  %.1f\n", one.runs, one.scans,
                one.dimension, one.limit, one.factor, std::exp(sum / n), 100.0 * held / n,
                100.0 * accused / n, 100.0 * consistent / n);
    std::fflush(stdout);
    EXPECT_NEAR(std::exp(sum / n), one.factor, 0.02 * one.factor);
    EXPECT_GT(held / n, 0.95 - share_errors(0.05, studies) - 0.01);
    if (one.factor == 1.0) {
      EXPECT_LT(accused / n, 0.05 + share_errors(0.05, studies));
    }
    if (one.factor == 1.1) {
      EXPECT_LT(consistent / n, 0.05 + share_errors(0.05, studies));
    }
  }
}

}  // namespace
}  // namespace montecarta::analysis
