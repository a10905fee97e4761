// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/benchmark/archive_entry.hpp"

#include "engine/records/fingerprint.hpp"
#include "experiments/benchmark/benchmark_study.hpp"
#include "experiments/files/files.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

TEST(ArchivedScore, HasSixteenBitsAndIsArchivedAsItself) {
  for (const double score : {1.0, 1.0 / 3.0, 0.00123456789, 98765.4321, 3e-30, 0.0}) {
    EXPECT_NEAR(archived(score), score, score * std::ldexp(1.0, -16));
    EXPECT_EQ(archived(archived(score)), archived(score));
  }
  EXPECT_EQ(archived(1.0), 1.0);
  EXPECT_TRUE(std::isnan(archived(kNaN)));
  EXPECT_EQ(archived(std::numeric_limits<double>::infinity()),
            std::numeric_limits<double>::infinity());
  // To the nearest: 1 + 2^-16 lies halfway to the next number, and goes to the even one.
  EXPECT_EQ(archived(1.0 + std::ldexp(1.0, -16)), 1.0);
  EXPECT_EQ(archived(1.0 + 3.0 * std::ldexp(1.0, -16)), 1.0 + std::ldexp(1.0, -14));
}

/// An entry of 2000 runs with numbers that cannot be packed.
ArchiveEntry full_entry() {
  ArchiveEntry entry{.world = "corridor_easy",
                     .label = "mine",
                     .filter = "ekf_slam",
                     .cell = "ekf_slam label=mine",
                     .program_files = {{"mine.py", std::string(64, 'c')}},
                     .study_sha256 = std::string(64, 'a'),
                     .drives_sha256 = std::string(64, 'b'),
                     .seed = 7,
                     .runs = 2000,
                     .failed = 1,
                     .first_failure = "lost",
                     .verdict = {},
                     .cpu_seconds = 0.25,
                     .made_by = {{"version", "1"}},
                     .blocks = {},
                     .scores = {}};
  entry.verdict = {.answer = Answer::optimistic,
                   .is_slight = true,
                   .within = 1.1,
                   .level = 0.95,
                   .ratio = 1.25,
                   .interval = {1.125, std::numeric_limits<double>::infinity()},
                   .families = analysis::Json::array()};
  for (std::uint64_t block = 0; block < 32; ++block) entry.blocks.push_back(UINT64_MAX - block);
  for (std::vector<double>& scores : entry.scores) {
    for (int run = 0; run < 2000; ++run) scores.push_back(archived(std::exp(std::sin(run))));
    scores[3] = kNaN;
  }
  return entry;
}

TEST(ArchiveEntry, IsReadAsItWasWrittenAndSmall) {
  const ScratchFolder folder;
  const ArchiveEntry entry = full_entry();
  write_entry(entry, folder.path());
  const auto path = path_of_entry(folder.path(), entry.world, entry.label);
  const ArchiveEntry read = read_entry(path);
  EXPECT_EQ(text_of(read), text_of(entry));
  EXPECT_EQ(read.verdict.answer, Answer::optimistic);
  EXPECT_TRUE(read.verdict.is_slight);
  EXPECT_EQ(read.verdict.interval.upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(read.blocks, entry.blocks);
  EXPECT_EQ(read.scores[2][1999], entry.scores[2][1999]);
  EXPECT_TRUE(std::isnan(read.scores[0][3]));
  EXPECT_LT(text_of(entry).size(), 27'000U);  // which leaves room for the families of a verdict
}

TEST(ArchiveEntry, PositionRmseIsTheMeanOverCompleteRuns) {
  ArchiveEntry entry;
  entry.scores[kArchivedPositionRmse] = {3.0, kNaN, 4.0};
  EXPECT_DOUBLE_EQ(entry.position_rmse(), 3.5);
}

TEST(DrivesSha256, DependsOnWhatDecidesTheDrivesAlone) {
  const auto of = [](const std::string& world, const std::string& cell, std::uint64_t runs) {
    return drives_sha256(resolved_text(benchmark_study(world, cell, runs)));
  };
  const std::string hash = of("corridor_easy", "ekf_slam", 100);
  EXPECT_EQ(of("corridor_easy", "ukf_slam label=mine motion_noise=2", 2000), hash);
  EXPECT_NE(of("corridor_hard", "ekf_slam", 100), hash);
  const std::string text = resolved_text(benchmark_study("corridor_easy", "ekf_slam", 100));
  std::string other = text;
  other.replace(other.find("seed = ") + 7, 1, "9");
  EXPECT_NE(drives_sha256(other), hash);
}

TEST(ShippedArchive, IsSmallAndOfTheWorldsThatAreShipped) {
  std::uintmax_t all = 0;
  for (const ArchiveEntry& entry : read_entries(shipped_archive())) {
    const std::string name = entry.world + "/" + entry.label;
    const std::uintmax_t size =
        fs::file_size(path_of_entry(shipped_archive(), entry.world, entry.label));
    EXPECT_LE(size, 30'000U) << name;
    all += size;
    const std::string text = resolved_text(benchmark_study(entry.world, entry.cell, entry.runs));
    EXPECT_EQ(sha256(text), entry.study_sha256) << name;
    EXPECT_EQ(drives_sha256(text), entry.drives_sha256) << name;
  }
  EXPECT_GT(all, 0U);
  EXPECT_LE(all, 8'000'000U);
}

TEST(ShippedArchive, HoldsEveryShippedFilterInEveryWorldThatSuitsIt) {
  for (const std::string& world : benchmark_worlds()) {
    for (const BenchmarkFilter& filter : benchmark_filters()) {
      if (!suits(world, filter.cell)) continue;
      EXPECT_TRUE(fs::exists(path_of_entry(shipped_archive(), world, filter.label)))
          << world << "/" << filter.label;
    }
  }
}

}  // namespace
}  // namespace montecarta::experiments
