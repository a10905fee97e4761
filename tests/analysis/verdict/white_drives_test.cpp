// SPDX-License-Identifier: BSD-3-Clause
// A few drives of white innovations (STATISTICS (9.5)). `MONTECARTA_STUDIES=1000
// build/analysis_tests --gtest_filter='*SlowWhiteDrives*'` prints the tables of chapter 9.
#include "analysis/verdict/innovations.hpp"
#include "analysis/verdict/whole_error.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Innovations of one component, whose variance is `ratio` times the claimed one. A share of it has
/// an autoregression of `memory` (1: the same over a whole run), and the rest is white.
struct FewDrives {
  std::size_t runs = 1, scans = 3000;
  double ratio = 1.0, share = 0.0, memory = 0.0;
  Noise noise = Noise::gaussian;
  double within = kUsualMargin;

  struct Found {
    WholeError sums;
    bool are_white = false, have_bias = false;
  };
  Found found(std::uint64_t seed) const {
    WholeError sums(1, scans);
    InnovationSums innovations(scans, 1);
    const std::vector<double> times = scan_times(scans);
    for (std::uint64_t run = 0; run < runs; ++run) {
      RngStream draw({seed, run, 0, 4, Draw::test});
      WhitenedRun errors{1, std::vector<double>(scans), {}};
      errors.number = run;
      double slow = draw.normal();
      for (double& error : errors.whitened) {
        slow = memory * slow + std::sqrt(1.0 - memory * memory) * draw.normal();
        error = std::sqrt(ratio) *
                (std::sqrt(share) * slow + std::sqrt(1.0 - share) * draw_noise(noise, draw));
      }
      errors.standardised = errors.whitened;
      const std::vector<double> nis = nees_of(errors);
      sums.add(errors, nis);
      innovations.add(run, times, nis, std::vector<std::uint32_t>(scans, 1), errors.standardised);
    }
    const Innovations judged = innovations.result(times, kLevel, within);
    return {std::move(sums), judged.whiteness() == Whiteness::white,
            judged.components.front().has_bias()};
  }
  /// The verdict by the law of white errors, or whatever their memory is.
  Verdict white(const Found& found) const { return judged(found, &WholeError::white_families); }
  Verdict any(const Found& found) const { return judged(found, &WholeError::families); }

 private:
  static constexpr double kLevel = 0.975;  // whiteness and size of one sensor
  template <class Families>
  Verdict judged(const Found& found, Families families) const {
    const std::vector<std::string> names = letters(1);
    const std::vector<double> times = scan_times(scans);
    const ErrorNames all{names, times};
    return judge((found.sums.*families)(kLevel, all, nullptr), kLevel, within, runs,
                 found.sums.beside_tests(all));
  }
};

bool has_size_within(const Verdict& verdict) {
  const FamilyTest* size = verdict.find(Family::size);
  return size != nullptr && !is_rejected(verdict) &&
         is_within_margin(Family::size, size->members.front(), verdict.within);
}

TEST(WhiteDrives, KnowTheirOwnSizeBetterThanThatOfOthers) {
  const FewDrives one{.within = 1.6};
  const auto found = one.found(3);
  EXPECT_TRUE(found.are_white);
  Verdict white = one.white(found);
  const Verdict any = one.any(found);
  EXPECT_NEAR(white.ratio().upper - white.ratio().lower, 2.0 * 2.24 * std::sqrt(2.0 / 3000.0),
              0.02);
  EXPECT_GT(any.ratio().upper, 1.7) << "an error that lasts would not show";
  EXPECT_EQ(white.answer, Answer::consistent) << "if nothing lasts";
  take_for_white_drives(any, white);
  EXPECT_EQ(white.answer, Answer::undecided);
  EXPECT_EQ(white.over_drives.upper, any.ratio().upper);
}

// What is shown to be off on this drive stays shown where its margin is not.
TEST(WhiteDrives, ThatAreOffWithinTheMarginAreSlightlySo) {
  const FewDrives one{.ratio = 1.4, .within = 2.0};
  const auto found = one.found(5);
  Verdict white = one.white(found);
  EXPECT_EQ(white.answer, Answer::consistent) << "if nothing lasts";
  take_for_white_drives(one.any(found), white);
  EXPECT_EQ(white.answer, Answer::optimistic);
  EXPECT_TRUE(white.is_slight());
}

TEST(WhiteDrives, AreJudgedByStretchesToo) {
  const FewDrives one{.scans = 800}, many{.runs = 10, .scans = 50};
  const Verdict white = one.white(one.found(4));
  ASSERT_NE(white.find(Family::stretch), nullptr);
  EXPECT_EQ(white.find(Family::stretch)->members.size(), 8u);
  EXPECT_EQ(white.find(Family::component), nullptr) << "the only component is the whole";
  EXPECT_TRUE(many.white(many.found(4)).families.empty()) << "runs show how they vary";
}

TEST(WhiteDrives, WithHeavyTailsAreNotCalledOffForThem) {
  const FewDrives study{.scans = 300, .noise = Noise::t5};
  double off = 0.0;
  for (std::uint64_t k = 0; k < 40; ++k) {
    off += is_rejected(study.white(study.found(1 + k)), Family::size) ? 1.0 : 0.0;
  }
  EXPECT_LE(off, 5.0);
}

std::vector<FewDrives> drives_of_the_table() {
  std::vector<FewDrives> lines = {{.scans = 200},
                                  {.scans = 3000},
                                  {.runs = 5, .scans = 600},
                                  {.scans = 3000, .noise = Noise::t5},
                                  {.scans = 3000, .noise = Noise::laplace},
                                  {.scans = 3000, .noise = Noise::uniform}};
  for (const double ratio : {1.1, 1.0 / 1.1}) {
    for (const auto& [share, memory] : {std::pair{0.0, 0.0},
                                        {1.0, 0.05},
                                        {1.0, 0.3},
                                        {1.0, 0.95},
                                        {0.05, 0.9},
                                        {0.05, 0.99},
                                        {0.05, 0.999},
                                        {0.02, 1.0},
                                        {0.05, 1.0},
                                        {0.1, 1.0},
                                        {0.3, 1.0}}) {
      lines.push_back({.ratio = ratio, .share = share, .memory = memory});
    }
  }
  return tested_lines(std::move(lines), [](const FewDrives& line) {
    return line.share == 0.0 || line.memory == 1.0;
  });
}

/// Numbers of studies.
struct DriveCounts {
  double white = 0.0, accused = 0.0;
  double by_white_law = 0.0;  ///< without a finding, and with a size within the margin by that law
  double answered = 0.0;      ///< and by that of any memory
};

DriveCounts counts_of(const FewDrives& line, std::uint64_t studies) {
  DriveCounts count;
  for (std::uint64_t k = 0; k < studies; ++k) {
    const FewDrives::Found found = line.found(1 + k);
    count.white += found.are_white ? 1.0 : 0.0;
    const Verdict judged = found.are_white ? line.white(found) : line.any(found);
    // Single scans of so few runs have the law of Gaussian errors alone.
    const bool is_off = line.noise == Noise::gaussian ? is_rejected(judged)
                                                      : is_rejected(judged, Family::size) ||
                                                            is_rejected(judged, Family::stretch);
    count.accused += is_off || !found.are_white || found.have_bias ? 1.0 : 0.0;
    if (!has_size_within(judged)) continue;
    count.by_white_law += found.are_white && !found.have_bias ? 1.0 : 0.0;
    count.answered += has_size_within(line.any(found)) ? 1.0 : 0.0;
  }
  return count;
}

TEST(SlowWhiteDrives, OfARightFilterAreSparedAndOthersNotCalledConsistent) {
  const std::uint64_t studies = studies_of_a_line(60);
  std::printf(
      "runs  scans  ratio  share  memory  noise  white [%%]  accused [%%]  "
      "within by the white law [%%]  also by any memory [%%]\n");
  for (const FewDrives& line : drives_of_the_table()) {
    const DriveCounts count = counts_of(line, studies);
    const auto n = static_cast<double>(studies);
    std::printf("%zu  %4zu  %.3f  %.2f  %.3f  %s  %.1f  %.1f  %.1f  %.1f\n", line.runs, line.scans,
                line.ratio, line.share, line.memory, name_of(line.noise), 100.0 * count.white / n,
                100.0 * count.accused / n, 100.0 * count.by_white_law / n,
                100.0 * count.answered / n);
    std::fflush(stdout);
    if (line.ratio == 1.0) {
      EXPECT_LT(count.accused / n, 0.05 + share_errors(0.05, studies));
    }
    if (line.ratio != 1.0) {
      EXPECT_LT(count.answered / n, 0.05 + share_errors(0.05, studies));
    }
  }
}

}  // namespace
}  // namespace montecarta::analysis
