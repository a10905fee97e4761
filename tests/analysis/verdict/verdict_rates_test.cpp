// SPDX-License-Identifier: BSD-3-Clause
// Promises of the verdict, checked by simulated studies. This prints the tables of STATISTICS 5 and
// 18, and without the variable a sample of their lines:
//   MONTECARTA_STUDIES=2000 build/analysis_tests --gtest_filter='*SlowVerdict*'
#include "analysis/verdict/interim_analysis.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace montecarta::analysis {
namespace {

struct Setting {
  std::uint64_t runs;
  std::size_t scans, dimension;
  bool is_sample = false;  ///< tested without the whole table
};

void PrintTo(const Setting& setting, std::ostream* out) {
  *out << setting.runs << " runs of " << setting.scans << " scans, " << setting.dimension
       << " components";
}

void print_share(const char* what, const PlantedLaw& law, const Setting& setting, double share) {
  std::printf("%-10s  %4d runs  %4zu scans  %2zu components  %-8s  %-18s  %5.2f %%\n", what,
              static_cast<int>(setting.runs), setting.scans, setting.dimension, name_of(law.noise),
              name_of(law.memory), 100.0 * share);
  std::fflush(stdout);
}

/// Share of studies in which a filter with the covariance that it reports is called something else.
double share_accused(const PlantedLaw& law, const Setting& setting, std::uint64_t studies) {
  const double share = share_of_studies(studies, [&](std::uint64_t study) {
    return is_rejected(verdict_of(law, study, setting.runs, setting.scans));
  });
  print_share("accused", law, setting, share);
  return share;
}

constexpr double kError = 0.05;

class SlowVerdictRates : public testing::TestWithParam<Setting> {};

// A filter with Gaussian errors of its covariance is rejected in at most 5 % of studies.
TEST_P(SlowVerdictRates, AccuseAConsistentFilterInAtMostFivePercent) {
  const Setting& setting = GetParam();
  const std::uint64_t studies = studies_of_a_line(200);
  for (const Memory memory : kMemories) {
    const double accused =
        share_accused({.dimension = setting.dimension, .memory = memory}, setting, studies);
    EXPECT_LT(accused, kError + share_errors(kError, studies)) << name_of(memory);
  }
}

/// For SlowVerdictRates and SlowVerdictTails.
std::vector<Setting> tested_settings(std::vector<Setting> settings) {
  return tested_lines(std::move(settings),
                      [](const Setting& setting) { return setting.is_sample; });
}

INSTANTIATE_TEST_SUITE_P(Of, SlowVerdictRates,
                         testing::ValuesIn(tested_settings({{3, 100, 3},
                                                            {5, 64, 3, true},
                                                            {8, 64, 3},
                                                            {10, 100, 1},
                                                            {20, 20, 1},
                                                            {20, 100, 3, true},
                                                            {20, 100, 6},
                                                            {20, 64, 15},
                                                            {50, 64, 3},
                                                            {50, 1000, 2},
                                                            {200, 64, 3},
                                                            {1000, 20, 3}})));

class SlowVerdictTails : public testing::TestWithParam<Setting> {};

// So is a filter with errors of its covariance that are not Gaussian.
TEST_P(SlowVerdictTails, AccuseNoCovarianceOfErrorsThatAreNotGaussian) {
  const Setting& setting = GetParam();
  const std::uint64_t studies = studies_of_a_line(200);
  for (const Noise noise : kNoises) {
    for (const Memory memory : {Memory::white, Memory::ar95, Memory::constant}) {
      if (noise == Noise::gaussian || (memory != Memory::white && !is_table_wanted())) continue;
      const PlantedLaw law{.dimension = setting.dimension, .memory = memory, .noise = noise};
      EXPECT_LT(share_accused(law, setting, studies), kError + share_errors(kError, studies))
          << name_of(noise) << ", " << name_of(memory);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, SlowVerdictTails,
    testing::ValuesIn(
        tested_settings({{8, 64, 3}, {20, 64, 3, true}, {50, 64, 3}, {200, 64, 3}, {50, 64, 1}})));

// Heavy tails are named, and those of a Gaussian are not.
TEST(SlowVerdictTails, NamesThem) {
  const std::uint64_t studies = studies_of_a_line(50);
  for (const Noise noise : kNoises) {
    const Setting setting{200, 64, 3};
    const PlantedLaw law{.noise = noise};
    const double named = share_of_studies(studies, [&](std::uint64_t study) {
      return is_rejected(verdict_of(law, study, setting.runs, setting.scans), Family::tails);
    });
    print_share("heavy tail", law, setting, named);
    const bool is_heavy = noise != Noise::gaussian && noise != Noise::uniform;
    if (is_heavy) {
      EXPECT_GT(named, noise == Noise::t5 ? 0.75 : 0.9) << name_of(noise);
    } else {
      EXPECT_LT(named, 0.0125 + share_errors(0.0125, studies)) << name_of(noise);
    }
  }
}

/// A fault at the margin of one kind: to be called consistent in at most 2.5 % of studies.
struct MarginCase {
  const char* name;
  PlantedLaw law;
  std::uint64_t runs = 300;
  double within = 1.3;
  std::size_t scans = 64;
  bool is_sample = true;
};

void PrintTo(const MarginCase& one, std::ostream* out) { *out << one.name; }

class SlowVerdictMargin : public testing::TestWithParam<MarginCase> {};

TEST_P(SlowVerdictMargin, IsCalledConsistentSeldom) {
  const MarginCase& one = GetParam();
  const std::uint64_t studies = studies_of_a_line(200);
  double consistent = 0.0, wrong_side = 0.0, refused = 0.0, covered = 0.0;
  const auto share = 1.0 / static_cast<double>(studies);
  for (std::uint64_t study = 0; study < studies; ++study) {
    const Verdict found = verdict_of(one.law, study, one.runs, one.scans, one.within);
    const Answer wrong = one.law.ratio < 1.0 ? Answer::optimistic : Answer::conservative;
    consistent += found.answer == Answer::consistent ? share : 0.0;
    wrong_side += found.answer == wrong ? share : 0.0;
    refused += found.is_refused ? share : 0.0;
    const Interval ratio = found.ratio();
    covered += ratio.lower <= one.law.ratio && one.law.ratio <= ratio.upper ? share : 0.0;
  }
  std::printf(
      "%-26s  %3d runs  within %.1f  consistent %5.2f %%  refused %5.2f %%  "
      "of the wrong side %5.2f %%  interval holds the ratio %5.1f %%\n",
      one.name, static_cast<int>(one.runs), one.within, 100.0 * consistent, 100.0 * refused,
      100.0 * wrong_side, 100.0 * covered);
  std::fflush(stdout);
  EXPECT_LT(consistent, 0.025 + share_errors(0.025, studies));
  EXPECT_LT(wrong_side, 0.025 + share_errors(0.025, studies));
  if (one.law.log_scale < one.within - 1.0) {  // else it is refused for its scales, rightly
    EXPECT_LT(refused, 0.05 + share_errors(0.05, studies));
  }
  const bool is_size = one.law.log_scale > 0.0 || one.law.ratio != 1.0;
  const double least = one.runs >= 100 ? 0.93 : 0.90;
  if (is_size) {
    EXPECT_GT(covered, least - share_errors(least, studies));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, SlowVerdictMargin,
    testing::ValuesIn(tested_lines(
        std::vector{
            MarginCase{"size", {.memory = Memory::ar95, .ratio = 1.3}},
            MarginCase{"small size", {.memory = Memory::ar95, .ratio = 1 / 1.3}},
            MarginCase{"component", {.memory = Memory::ar95, .by_component = {1.0, 1.0, 1.3}}},
            MarginCase{"stretch", {.memory = Memory::ar95, .first_half = 1.3}},
            MarginCase{"bias", {.memory = Memory::ar95, .covered_bias = std::sqrt(0.3 / 0.7)}},
            MarginCase{"correlation", {.memory = Memory::ar95, .correlation = 0.3}},
            MarginCase{"own scales 0.3, white",
                       {.dimension = 1, .ratio = 1.2, .log_scale = 0.3},
                       49,
                       1.2,
                       16},
            MarginCase{
                "own scales 0.83, constant",
                {.dimension = 1, .memory = Memory::constant, .ratio = 1.5, .log_scale = 0.83},
                25,
                1.5,
                16},
            MarginCase{"own scales 0.83, white",
                       {.dimension = 1, .ratio = 2.0, .log_scale = 0.83},
                       100,
                       2.0,
                       16},
            MarginCase{"own scales 0.6, small",
                       {.memory = Memory::ar95, .ratio = 0.5, .log_scale = 0.6},
                       100,
                       2.0,
                       64,
                       false},
            MarginCase{"own scales 0.83, white, 3",
                       {.memory = Memory::white, .ratio = 2.0, .log_scale = 0.83},
                       25,
                       2.0,
                       64,
                       false},
            MarginCase{"own scales 0.1, AR(1) 0.95",
                       {.memory = Memory::ar95, .ratio = 1.1, .log_scale = 0.1},
                       500,
                       1.1,
                       64,
                       false},
            MarginCase{
                "own scales 0.3, white, 3", {.ratio = 1.1, .log_scale = 0.3}, 500, 1.1, 64, false}},
        [](const MarginCase& one) { return one.is_sample; })));

// A true ratio of 1.1 is neither refused nor called consistent within 1.2 by mistake.
TEST(SlowVerdictMargin, IsRefusedSeldomInside) {
  const std::uint64_t studies = studies_of_a_line(100);
  for (const std::uint64_t runs : {100, 500}) {
    const double refused = share_of_studies(studies, [&](std::uint64_t study) {
      return verdict_of({.memory = Memory::ar95, .ratio = 1.1}, study, runs, 64, 1.2).is_refused;
    });
    std::printf("ratio 1.1 within 1.2, %d runs: refused %.2f %%\n", static_cast<int>(runs),
                100.0 * refused);
    EXPECT_LT(refused, 0.05 + share_errors(0.05, studies));
  }
}

/// Faults that an average of all squared errors does not see, and the family that names them.
struct PlantedCase {
  const char* name;
  PlantedLaw law;
  Family family;
};

void PrintTo(const PlantedCase& one, std::ostream* out) { *out << one.name; }

class SlowVerdictFaults : public testing::TestWithParam<PlantedCase> {};

TEST_P(SlowVerdictFaults, AreNotCalledConsistentAndNamed) {
  const std::uint64_t studies = studies_of_a_line(40);
  for (const Memory memory : {Memory::white, Memory::ar95}) {
    PlantedLaw law = GetParam().law;
    law.memory = memory;
    double consistent = 0.0, named = 0.0;
    for (std::uint64_t study = 0; study < studies; ++study) {
      const Verdict found = verdict_of(law, study, 200, 64, 1.2);
      consistent += found.answer == Answer::consistent ? 1.0 : 0.0;
      named += is_rejected(found, GetParam().family) ? 1.0 : 0.0;
    }
    const auto n = static_cast<double>(studies);
    std::printf("%-22s  %-10s  consistent %5.2f %%  named %5.1f %%\n", GetParam().name,
                name_of(memory), 100.0 * consistent / n, 100.0 * named / n);
    EXPECT_LE(consistent / n, 0.05) << name_of(memory);
    EXPECT_GE(named / n, 0.9 - share_errors(0.9, studies)) << name_of(memory);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, SlowVerdictFaults,
    testing::Values(
        PlantedCase{"components .5 .5 2", {.by_component = {0.5, 0.5, 2.0}}, Family::component},
        PlantedCase{"runs .5 or 1.5", {.scales = {0.5, 1.5}}, Family::between_runs},
        PlantedCase{"bias covered by P", {.covered_bias = 1.0}, Family::bias},
        PlantedCase{"halves .7 1.3", {.first_half = 0.7, .second_half = 1.3}, Family::stretch},
        PlantedCase{"correlation .9", {.correlation = 0.9}, Family::correlation},
        PlantedCase{
            "bias that cancels", {.covered_bias = 1.0, .cancels = true}, Family::bias_by_stretch},
        PlantedCase{"correlation that cancels",
                    {.correlation = 0.6, .cancels = true},
                    Family::correlation_by_stretch},
        PlantedCase{"components that cancel",
                    {.by_component = {0.5, 1.5, 1.0}, .cancels = true},
                    Family::component_by_stretch},
        PlantedCase{
            "one correlation of 15", {.dimension = 15, .correlation = 0.9}, Family::correlation}));

// Scales of 0.5 or 1.5 by chance have a mean of 1: they show no direction.
TEST(SlowVerdictFaults, OfRunsShowNoDirection) {
  const std::uint64_t studies = studies_of_a_line(100);
  const double directed = share_of_studies(studies, [&](std::uint64_t study) {
    const Answer found = verdict_of({.scales = {0.5, 1.5}}, study, 200, 64).answer;
    return found == Answer::optimistic || found == Answer::conservative;
  });
  std::printf("runs .5 or 1.5: a direction in %.1f %%\n", 100.0 * directed);
  EXPECT_LT(directed, 0.05 + share_errors(0.05, studies));
}

// Within 1.3 as above, so that the margin's test can fail, within 1.2 of 500 runs and 1.1 of 2000.
TEST(SlowVerdictPower, CallsAConsistentFilterConsistent) {
  const std::uint64_t studies = studies_of_a_line(40);
  const auto share_consistent = [&](const PlantedLaw& law, std::uint64_t runs, double within) {
    const double share = share_of_studies(studies, [&](std::uint64_t study) {
      return verdict_of(law, study, runs, 64, within).answer == Answer::consistent;
    });
    std::printf("within %.1f, %d runs, %s: consistent %.1f %%\n", within, static_cast<int>(runs),
                name_of(law.memory), 100.0 * share);
    return share;
  };
  for (const Memory memory : {Memory::white, Memory::ar95}) {
    EXPECT_EQ(verdict_of({.memory = memory}, 1, 300, 64, 1.3).answer, Answer::consistent);
    EXPECT_GE(share_consistent({.memory = memory}, 500, 1.2), 0.9 - share_errors(0.9, studies));
  }
  if (!is_table_wanted()) return;
  EXPECT_GE(share_consistent({.memory = Memory::ar95}, 2000, 1.1), 0.9);
  share_consistent({.dimension = 15}, 60, 1.2);
}

TEST(SlowVerdictPower, FindsSmallDeviations) {
  const std::uint64_t studies = studies_of_a_line(60);
  const auto share_found = [&](const PlantedLaw& law, std::uint64_t runs) {
    const double share = share_of_studies(studies, [&](std::uint64_t study) {
      return is_rejected(verdict_of(law, study, runs, 64));
    });
    std::printf("%-10s  ratio %.2f  %3d runs: found %.1f %%\n", name_of(law.memory), law.ratio,
                static_cast<int>(runs), 100.0 * share);
    return share;
  };
  for (const Memory memory : {Memory::white, Memory::ar95}) {
    const PlantedLaw large{.memory = memory, .ratio = 1.15};
    const PlantedLaw heading{.memory = memory, .by_component = {1.0, 1.0, 0.8}};
    EXPECT_GE(share_found(large, 50), 0.35 - share_errors(0.35, studies));
    EXPECT_GE(share_found(large, 100), 0.7 - share_errors(0.7, studies));
    EXPECT_GE(share_found(heading, 100), 0.3 - share_errors(0.3, studies));
    EXPECT_GE(share_found(heading, 200), 0.7 - share_errors(0.7, studies));
  }
}

/// A study that is analysed after 32, 64, ... 512 runs and stops when it is decided, as `until =
/// verdict` does.
struct Stopped {
  bool is_refused, is_consistent;
  std::uint64_t runs;
};

Stopped stopped_study(const PlantedLaw& law, std::uint64_t study, double within) {
  constexpr std::size_t kScans = 20;
  const InterimAnalysis analysis{.within = within, .runs_at_analyses = rounds_of(512)};
  const std::vector<std::string> components = letters(law.dimension);
  const std::vector<double> times = scan_times(kScans);
  WholeError sums(law.dimension, kScans);
  std::uint64_t runs = 0;
  for (const std::uint64_t look : analysis.runs_at_analyses) {
    add_runs(law, study, runs, look - runs, kScans, sums);
    runs = look;
    const Verdict found = judge(sums, {components, times}, analysis, runs, runs);
    const bool is_consistent = found.answer == Answer::consistent;
    if (is_consistent || found.is_refused) return {found.is_refused, is_consistent, runs};
  }
  return {false, false, runs};
}

TEST(SlowVerdictSequential, LooksCostNoErrors) {
  constexpr double kWithin = 1.2;
  for (const Memory memory : {Memory::white, Memory::ar95, Memory::constant}) {
    for (const double ratio : {1.0, 1.15, kWithin, 1.5, 2.0}) {
      const bool is_sample = ratio == kWithin || ratio == 2.0;
      if (!is_sample && !is_table_wanted()) continue;
      const std::uint64_t studies = studies_of_a_line(60);
      double refused = 0.0, consistent = 0.0, runs = 0.0;
      for (std::uint64_t study = 0; study < studies; ++study) {
        const Stopped found = stopped_study({.memory = memory, .ratio = ratio}, study, kWithin);
        refused += found.is_refused ? 1.0 : 0.0;
        consistent += found.is_consistent ? 1.0 : 0.0;
        runs += static_cast<double>(found.runs);
      }
      const auto n = static_cast<double>(studies);
      std::printf("%-10s  ratio %.2f  refused %5.1f %%  consistent %5.1f %%  %4.0f runs\n",
                  name_of(memory), ratio, 100.0 * refused / n, 100.0 * consistent / n, runs / n);
      std::fflush(stdout);
      if (ratio <= kWithin) {
        EXPECT_LT(refused / n, kError + share_errors(kError, studies));
      }
      if (ratio >= kWithin) {
        EXPECT_LT(consistent / n, 0.025 + share_errors(0.025, studies));
      }
      if (ratio == 2.0) {
        EXPECT_GT(refused / n, 0.95);
      }
    }
  }
}

}  // namespace
}  // namespace montecarta::analysis
