// SPDX-License-Identifier: BSD-3-Clause
// What until = verdict promises, by simulated studies that stop when their verdict is known:
// `MONTECARTA_STUDIES=4000 build/analysis_tests --gtest_filter='*SlowSequential*'` prints the whole
// table; without the variable 300 studies of a few lines.
#include "analysis/statistics/group_sequential.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kSequentialScans = 20;
constexpr std::uint64_t kSequentialRuns = 512;  // looks at 32, 64, 128, 256, 512

struct StoppedStudy {
  Consistency found;
  std::uint64_t runs = 0;
};

/// A study whose cell is judged at `look_level` at each look, and stops when it is decided.
StoppedStudy stopped_study(const GaussianLaw& law, std::uint64_t study, const BandWalks& walks,
                           double look_level) {
  const std::vector<double> times = scan_times(kSequentialScans, 0.2);
  NeesAccumulator sums(ErrorBlock::pose, Moments::spread, kSequentialScans);
  StoppedStudy stopped;
  for (const std::uint64_t look : rounds_of(kSequentialRuns)) {
    while (stopped.runs < look) sums.add(draw_nees(law, study, stopped.runs++, kSequentialScans));
    stopped.found = sums.result(times, 0.95, walks, kUsualMargin, look_level).consistency;
    if (stopped.found.verdict != Verdict::undecided) return stopped;
  }
  return stopped;
}

struct SequentialRates {
  double rejected = 0.0, consistent = 0.0, covered = 0.0, runs = 0.0;
};

SequentialRates sequential_rates(const GaussianLaw& law, double look_level, std::uint64_t studies) {
  const BandWalks walks(kSequentialScans);
  const double one = 1.0 / static_cast<double>(studies);
  SequentialRates rates;
  for (std::uint64_t study = 0; study < studies; ++study) {
    const StoppedStudy stopped = stopped_study(law, study, walks, look_level);
    const Consistency& found = stopped.found;
    const bool is_rejected =
        found.verdict == Verdict::optimistic || found.verdict == Verdict::conservative;
    rates.rejected += is_rejected ? one : 0.0;
    rates.consistent += found.verdict == Verdict::consistent ? one : 0.0;
    const bool holds = found.ratio.lower <= law.ratio && law.ratio <= found.ratio.upper;
    rates.covered += holds ? one : 0.0;
    rates.runs += one * static_cast<double>(stopped.runs);
  }
  return rates;
}

void print_line(const char* how, const GaussianLaw& law, const SequentialRates& rates) {
  std::printf("%-9s  %6.2f  %5.2f  %11.2f  %10.2f  %14.2f  %9.0f\n", how, law.memory, law.ratio,
              100.0 * rates.rejected, 100.0 * rates.consistent, 100.0 * rates.covered, rates.runs);
  std::fflush(stdout);
}

/// Three standard errors.
double reach_of(double share, std::uint64_t studies) {
  return 3.0 * std::sqrt(share * (1.0 - share) / static_cast<double>(studies));
}

class SlowSequential : public ::testing::TestWithParam<double> {};

TEST_P(SlowSequential, LooksCostNoErrors) {
  const double memory = GetParam();
  if (memory != 0.7 && memory != 1.0 && !is_table_wanted()) GTEST_SKIP() << kHowToGetTheTable;
  const std::uint64_t studies = studies_of_a_line(500);
  const double widened = level_of_a_look(0.95, rounds_of(kSequentialRuns).size());
  std::printf("interval   memory  ratio  rejected [%%]  consistent  interval holds  mean runs\n");
  for (const double ratio : {1.0, kUsualMargin, 1.0 / kUsualMargin}) {
    const GaussianLaw law{.memory = memory, .ratio = ratio};
    const SequentialRates rates = sequential_rates(law, widened, studies);
    print_line("widened", law, rates);
    EXPECT_GT(rates.covered, 0.95 - reach_of(0.05, studies)) << memory << ' ' << ratio;
    if (ratio == 1.0) {
      EXPECT_LT(rates.rejected, 0.05 + reach_of(0.05, studies)) << memory;
    } else {
      EXPECT_LT(rates.consistent, 0.025 + reach_of(0.025, studies)) << memory << ' ' << ratio;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfMemory, SlowSequential, ::testing::Values(0.0, 0.7, 0.95, 1.0));

// The interval of a single look, taken at five: the widening is needed.
TEST(SlowSequentialWithoutWidening, RejectsMoreThanPromised) {
  const GaussianLaw law{.memory = 1.0};
  const SequentialRates rates = sequential_rates(law, 0.95, studies_of_a_line(500));
  print_line("single", law, rates);
  EXPECT_GT(rates.rejected, 0.08);
  EXPECT_LT(rates.covered, 0.93);
}

}  // namespace
}  // namespace montecarta::analysis
