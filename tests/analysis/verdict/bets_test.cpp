// SPDX-License-Identifier: BSD-3-Clause
// The rates of STATISTICS 18 are printed by
//   MONTECARTA_STUDIES=1000 build/analysis_tests --gtest_filter='*SlowBets*'
#include "analysis/verdict/bets.hpp"

#include "engine/runs/monte_carlo.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>

namespace montecarta::analysis {
namespace {

Bets bets_on(const std::vector<double>& means) {
  Bets bets;
  for (const double mean : means) bets.add(mean);
  return bets;
}

/// Means of runs that scatter about `ratio` by the given standard deviation.
std::vector<double> scattered(double ratio, double deviation, std::size_t runs) {
  std::vector<double> means;
  for (std::size_t i = 0; i < runs; ++i) {
    means.push_back(ratio * (i % 2 == 0 ? 1.0 + deviation : 1.0 - deviation));
  }
  return means;
}

TEST(Bets, MultiplyTheCapitalOfEachStakeInEveryRun) {
  const std::vector<double> means = {0.5, 3.0, 1.7};
  constexpr double kMargin = 1.2;
  double expected = 0.0;
  for (int power = -6; power <= 4; ++power) {
    const double share = std::ldexp(kMargin, power) / (1.0 + std::ldexp(kMargin, power));
    double capital = 1.0;
    for (const double mean : means) capital *= 1.0 + share * (mean / kMargin - 1.0);
    expected += capital / 11.0;
  }
  EXPECT_NEAR(bets_on(means).log_capital(Side::above, kMargin), std::log(expected), 1e-13);
}

TEST(Bets, AreAFairGameBelowForTheWorstLawOfTheirVariance) {
  for (const double variance : {0.01, 0.5, 2.0, 10.0}) {
    const double most = 1.0 + variance;
    for (const double s : {0.01, 0.3, 1.0, 5.0}) {
      const double bound = largest_mean_exponential(s, variance);
      EXPECT_NEAR(bound, (1.0 - 1.0 / most) + std::exp(-s * most) / most, 1e-15);
      // The gamma law, which sums of squares of Gaussian errors nearly have.
      EXPECT_GE(bound, std::pow(1.0 + s * variance, -1.0 / variance));
      // Two values, one standard deviation to either side.
      const double deviation = std::sqrt(variance);
      if (deviation <= 1.0) {
        EXPECT_GE(bound, std::exp(-s) * std::cosh(s * deviation) - 1e-15);
      }
      EXPECT_LT(bound, largest_mean_exponential(s, 1.1 * variance));
    }
  }
}

/// The variance of numbers with mean 1 and twice its standard error, by the influence of each.
double safe_variance(const std::vector<double>& numbers) {
  const auto n = static_cast<double>(numbers.size());
  double variance = 0.0, squares = 0.0;
  for (const double x : numbers) variance += (x - 1.0) * (x - 1.0) / n;
  for (const double x : numbers) {
    squares += std::pow((x - 1.0) * (x - 1.0) - variance - 2.0 * variance * (x - 1.0), 2);
  }
  return variance * n / (n - 1.0) + 2.0 * std::sqrt(squares) / n;
}

TEST(Bets, PayBelowByASafeEstimateOfTheVariance) {
  std::vector<double> numbers;
  for (int i = 0; i < 30; ++i) numbers.push_back(i % 3 == 0 ? 2.0 : 0.2 + 0.02 * i);
  const double mean = std::accumulate(numbers.begin(), numbers.end(), 0.0) / 30.0;
  const Bets bets = bets_on(numbers);
  for (double& x : numbers) x /= mean;
  const double v = safe_variance(numbers);
  double expected = 0.0;
  for (int power = -6; power <= 1; ++power) {
    const double s = std::ldexp(1.0, power) / v;
    expected += std::exp(-30.0 * (s * 1.5 * mean + std::log(largest_mean_exponential(s, v)))) / 8.0;
  }
  EXPECT_NEAR(bets.log_capital(Side::below, 1.5), std::log(expected), 1e-9);
}

TEST(Bets, AreTheSameInPartsThatAreMerged) {
  const std::vector<double> means = scattered(1.3, 0.4, 101);
  Bets first, next;
  for (std::size_t i = 0; i < means.size(); ++i) (i < 40 ? first : next).add(means[i]);
  merge_into(first, next);
  const Bets all = bets_on(means);
  EXPECT_EQ(first.runs(), all.runs());
  for (const Side side : {Side::above, Side::below}) {
    EXPECT_NEAR(first.log_capital(side, 1.1), all.log_capital(side, 1.1), 1e-9);
  }
}

TEST(Bets, LeaveOutRunsWithoutErrors) {
  const Bets bets = bets_on({1.0, kNaN, 2.0});
  EXPECT_EQ(bets.runs(), 2U);
  EXPECT_EQ(bets.log_capital(Side::above, 1.1), bets_on({1.0, 2.0}).log_capital(Side::above, 1.1));
}

TEST(Bets, AreNotMadeBelowByFewRuns) {
  EXPECT_EQ(bets_on(scattered(0.1, 0.3, 19)).log_capital(Side::below, 1.1), 0.0);
  EXPECT_GT(bets_on(scattered(0.1, 0.3, 20)).log_capital(Side::below, 1.1), 5.0);
}

TEST(Bets, WinOnTheSideOfTheRatio) {
  constexpr double kMuch = 5.0;
  const auto capital = [](double ratio, Side side) {
    return bets_on(scattered(ratio, 0.5, 100)).log_capital(side, 1.1);
  };
  EXPECT_GT(capital(1.5, Side::above), kMuch);
  EXPECT_LT(capital(1.5, Side::below), 0.0);
  EXPECT_GT(capital(0.66, Side::below), kMuch);
  EXPECT_LT(capital(0.66, Side::above), 0.0);
  for (const double inside : {0.92, 1.0, 1.09}) {
    EXPECT_LT(capital(inside, Side::above), 0.0) << inside;
    EXPECT_LT(capital(inside, Side::below), 0.0) << inside;
  }
}

TEST(Bets, StandTheLeastAndTheLargestErrors) {
  for (const double least : {0.0, 1e-300, 1e-160}) {
    const Bets tiny = bets_on(std::vector<double>(50, least));
    EXPECT_GT(tiny.log_capital(Side::below, 1.1), 10.0) << least;
  }
  std::vector<double> means = scattered(1.0, 0.3, 50);
  means[7] = 1e60;
  const Bets huge = bets_on(means);
  EXPECT_GT(huge.log_capital(Side::above, 1.1), 10.0);
  EXPECT_LT(huge.log_capital(Side::below, 1.1), 0.0);
}

TEST(FamiliesOfBets, CountAlikeWhateverTheirNumberOfMembers) {
  const Bets fair = bets_on(scattered(1.0, 0.5, 100)), won = bets_on(scattered(1.5, 0.5, 100));
  const auto capital = [](const std::vector<Bets>& size, const std::vector<Bets>& stretch) {
    return log_capital(std::vector{size, stretch}, Side::above, 1.1);
  };
  const double alone = won.log_capital(Side::above, 1.1);
  EXPECT_NEAR(capital({won}, std::vector(8, fair)), alone - std::log(2.0), 0.01);
  EXPECT_NEAR(capital({won}, {}), alone, 1e-12);
  std::vector<Bets> one_of_eight(8, fair);
  one_of_eight[3] = won;
  EXPECT_NEAR(capital({fair}, one_of_eight), alone - std::log(16.0), 0.01);
}

TEST(FamiliesOfBets, RefuseWithHalfOfTheMoneyOnEachSide) {
  const Bets bets = bets_on(scattered(1.4, 0.5, 40));
  const std::vector<std::vector<Bets>> families = {{bets}};
  const double above = std::exp(bets.log_capital(Side::above, 1.1));
  const double below = std::exp(bets.log_capital(Side::below, 1.1));
  const double level = 1.0 - 2.0 / (above + below);
  EXPECT_EQ(refused_side(families, 1.1, level - 1e-6), Side::above);
  EXPECT_FALSE(refused_side(families, 1.1, level + 1e-6));
  EXPECT_FALSE(refused_side({}, 1.1, 0.95));
}

/// Scales of runs of their own: squared errors of a run are multiplied by a log-normal factor with
/// mean 1.
struct RatesCase {
  const char* name;
  Memory memory;
  double deviation_of_scales;  ///< of their logarithm
};

void PrintTo(const RatesCase& one, std::ostream* out) { *out << one.name; }

double mean_square(const WhitenedRun& run, std::size_t first, std::size_t end, std::size_t step) {
  double sum = 0.0, n = 0.0;
  for (std::size_t k = first; k < end; k += step, n += 1.0) {
    sum += run.whitened[k] * run.whitened[k];
  }
  return sum / n;
}

constexpr std::size_t kMembers = 12;  // size, three components, eight eighths
constexpr std::uint64_t kMostRuns = 512;
using MeansOfRun = std::array<double, kMembers>;

/// Means of the runs of a study of three components, with ratio 1.
std::vector<MeansOfRun> drawn_means(const RatesCase& one, std::uint64_t study) {
  constexpr std::size_t kLength = 32 * 3;
  std::vector<MeansOfRun> all;
  for (std::uint64_t run = 0; run < kMostRuns; ++run) {
    const WhitenedRun errors = drawn_run({.memory = one.memory}, study, run, 32);
    RngStream draw({.seed = study, .run = run, .index = 1, .purpose = Draw::test});
    const double d = one.deviation_of_scales;
    MeansOfRun& means = all.emplace_back();
    means[0] = mean_square(errors, 0, kLength, 1);
    for (std::size_t k = 0; k < 3; ++k) means[1 + k] = mean_square(errors, k, kLength, 3);
    for (std::size_t k = 0; k < 8; ++k) {
      means[4 + k] = mean_square(errors, k * kLength / 8, (k + 1) * kLength / 8, 1);
    }
    const double scale = std::exp(2.0 * d * draw.normal() - 2.0 * d * d);
    for (double& mean : means) mean *= scale;
  }
  return all;
}

/// Number of runs after which a filter with this ratio is refused, of 32, 64, ...; nullopt if
/// never.
std::optional<std::uint64_t> refused_after(const std::vector<MeansOfRun>& means, double ratio,
                                           double margin) {
  std::vector<std::vector<Bets>> families = {std::vector<Bets>(1), std::vector<Bets>(3),
                                             std::vector<Bets>(8)};
  std::uint64_t run = 0;
  for (const std::uint64_t look : rounds_of(kMostRuns)) {
    for (; run < look; ++run) {
      const double* mean = means[run].data();
      for (std::vector<Bets>& members : families) {
        for (Bets& bets : members) bets.add(ratio * *mean++);
      }
    }
    if (refused_side(families, margin, 0.95)) return look;
  }
  return std::nullopt;
}

class SlowBetsRates : public testing::TestWithParam<RatesCase> {};

TEST_P(SlowBetsRates, RefuseAtMostFivePercentAtTheMarginAndFindWhatIsBeyond) {
  constexpr double kMargin = 1.1;
  constexpr std::array kRatios = {1.0 / 2.0, 1.0 / 1.5, 1.0 / 1.2, 1.0 / kMargin,
                                  kMargin,   1.2,       1.5,       2.0};
  const std::uint64_t studies = studies_of_a_line(50);
  std::array<double, kRatios.size()> refused{}, runs{};
  for (std::uint64_t study = 0; study < studies; ++study) {
    const auto means = drawn_means(GetParam(), study);
    for (std::size_t k = 0; k < kRatios.size(); ++k) {
      const auto found = refused_after(means, kRatios[k], kMargin);
      refused[k] += found ? 1.0 / static_cast<double>(studies) : 0.0;
      runs[k] += static_cast<double>(found.value_or(kMostRuns)) / static_cast<double>(studies);
    }
  }
  for (std::size_t k = 0; k < kRatios.size(); ++k) {
    std::printf("%-26s  ratio %.3f  refused %5.1f %%  %4.0f runs\n", GetParam().name, kRatios[k],
                100.0 * refused[k], runs[k]);
    const double times_off = std::max(kRatios[k], 1.0 / kRatios[k]);
    if (times_off < 1.15) {
      EXPECT_LE(refused[k], 0.05 + share_errors(0.05, studies)) << kRatios[k];
    } else if (times_off > 1.4 && GetParam().deviation_of_scales < 0.5) {
      EXPECT_GE(refused[k], 0.9) << kRatios[k];
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, SlowBetsRates,
    testing::Values(RatesCase{"white", Memory::white, 0.0},
                    RatesCase{"AR(1) 0.95", Memory::ar95, 0.0},
                    RatesCase{"constant", Memory::constant, 0.0},
                    RatesCase{"constant, scales of 0.3", Memory::constant, 0.3},
                    RatesCase{"AR(1) 0.95, scales of 0.83", Memory::ar95, 0.83}));

}  // namespace
}  // namespace montecarta::analysis
