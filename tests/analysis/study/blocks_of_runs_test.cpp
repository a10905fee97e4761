// SPDX-License-Identifier: BSD-3-Clause
// Sums over blocks of runs, merged, are the sums over all runs.
#include "analysis/render/tables/terminal.hpp"
#include "analysis/run/criteria_of.hpp"
#include "analysis/study/cell_sums.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/stored_sums.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/calibration.hpp"
#include "analysis/verdict/convention_hints.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <tuple>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kRuns = 2 * kRunsOfABlock + 3;
constexpr double kRounding = 1e-9;  // relative

/// Everything a cell says in numbers, under names.
std::vector<Frame::Column> all_of(const CellAnalysis& cell) {
  std::vector<Frame::Column> all = series_of(cell);
  for (const Frame::Entry& number : numbers_of(cell)) {
    all.push_back({number.name, number.units, {number.number}});
  }
  for (const FamilyTest& family : cell.verdict.families) {
    for (const Frame::Column& column : family_frame(family).columns) {
      all.push_back({key_of(family.family) + " " + column.name, column.units, column.numbers});
    }
  }
  for (const Score& score : all_scores()) {
    all.push_back({score.name, score.units, cell.scores.column(score.name)});
  }
  for (const JudgedPits& pits : cell.get<Calibrations>()) {
    all.push_back({"calibration of " + pits.quantity, "1",
                   std::vector<double>{pits.test.counts.begin(), pits.test.counts.end()}});
  }
  return all;
}

void expect_near(const CellAnalysis& found, const CellAnalysis& wanted) {
  const std::vector<Frame::Column> a = all_of(found), b = all_of(wanted);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_EQ(a[k].name, b[k].name);
    ASSERT_EQ(a[k].numbers.size(), b[k].numbers.size()) << a[k].name;
    for (std::size_t i = 0; i < a[k].numbers.size(); ++i) {
      const double x = a[k].numbers[i], y = b[k].numbers[i];
      if (x == y || (std::isnan(x) && std::isnan(y))) continue;
      EXPECT_NEAR(x, y, kRounding * std::max(1.0, std::abs(y))) << a[k].name << " " << i;
    }
  }
}

std::string tables_of(const StudyAnalysis& study) {
  std::ostringstream tables;
  print_all(tables, study, 100);
  return tables.str();
}

void expect_same_bits(const StudyAnalysis& found, const StudyAnalysis& wanted) {
  EXPECT_EQ(tables_of(found), tables_of(wanted));
  for (std::size_t c = 0; c < wanted.cells.size(); ++c) {
    const std::vector<Frame::Column> a = all_of(found.cells[c]), b = all_of(wanted.cells[c]);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      ASSERT_EQ(a[k].numbers.size(), b[k].numbers.size());
      const std::size_t bytes = a[k].numbers.size() * sizeof(double);
      EXPECT_EQ(std::memcmp(a[k].numbers.data(), b[k].numbers.data(), bytes), 0) << a[k].name;
    }
  }
}

/// A result with every column.
void write_simulated(const std::filesystem::path& path) {
  write_synthetic_result(path, kRuns, 48, {}, store_everything);
}

class BlocksOfRuns : public testing::TestWithParam<const char*> {
 protected:
  BlocksOfRuns() {
    if (GetParam() == std::string("simulated")) write_simulated(path_);
    if (GetParam() == std::string("recorded")) write_recorded_result(path_, kRuns, 240);
  }
  /// All runs of a cell one after another, without blocks.
  CellAnalysis one_after_another(const ResultFile& file, const CellAnalysis& blocks) const {
    const auto& stored = *std::ranges::find(file.cells(), blocks.label, &StoredCell::label);
    const RunCriteria criteria = criteria_of(file, 0.95);
    const RunReader reader(file, stored);
    CellSums sums(criteria);
    MeasuredRun run;
    for (std::size_t i = 0; i < file.runs().size(); ++i) {
      if (file.status(stored)[i] != RunStatus::complete) continue;
      reader.read(i, run.rows);
      run.measure(criteria, stored.particles);
      sums.add(run);
    }
    CellAnalysis cell;
    cell.label = blocks.label;
    cell.failures = blocks.failures;
    cell.runs = blocks.runs;
    cell.particles = blocks.particles;
    sums.put(cell);
    return cell;
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

TEST_P(BlocksOfRuns, AreMergedToTheSumsOverAllRuns) {
  const ResultFile file(path_);
  for (const StoredCell& stored : file.cells()) {
    SCOPED_TRACE(stored.label);
    const CellAnalysis blocks =
        analyze_cell(file, stored, 0.95, kRuns, Parallel::serial(), std::nullopt);
    EXPECT_GT(blocks.complete, 2 * kRunsOfABlock);
    expect_near(blocks, one_after_another(file, blocks));
  }
}

TEST_P(BlocksOfRuns, GiveTheSameBitsOnAnyNumberOfThreads) {
  const ResultFile file(path_);
  const StudyAnalysis one = analyze(file);
  for (const Backend backend : {Backend::tbb, Backend::openmp}) {
    const StudyAnalysis many = analyze(file, 0.95, Parallel(backend, 3));
    expect_same_bits(many, one);
  }
}

TEST_P(BlocksOfRuns, GiveTheSameBitsWhereTheirSumsAreStored) {
  const ResultFile file(path_);
  write_group(folder_ / "sums.h5", path_, sums_to_store(file, Parallel::serial()));
  const ResultFile sums(folder_ / "sums.h5");
  EXPECT_LT(sums.runs().size(), kRuns);
  const StudyAnalysis stored = analyze(sums), wanted = analyze(file);
  expect_same_bits(stored, wanted);
  for (std::size_t c = 0; c < wanted.cells.size(); ++c) {
    ASSERT_EQ(stored.cells[c].failures.size(), wanted.cells[c].failures.size());
    for (std::size_t k = 0; k < wanted.cells[c].failures.size(); ++k) {
      const FailedRun &a = stored.cells[c].failures[k], &b = wanted.cells[c].failures[k];
      EXPECT_EQ(std::tie(a.run, a.step, a.reason), std::tie(b.run, b.step, b.reason));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, BlocksOfRuns, testing::Values("simulated", "recorded"),
                         [](const auto& file) { return std::string(file.param); });

/// Of imported estimates, which come in no file of ours here.
TEST(BlocksOfImportedRuns, AreMergedToTheSumsOverAllRuns) {
  const SyntheticStudy study{.scans = 20};
  const std::vector<double> times = study.times();
  const RunCriteria criteria = criteria_of_scans(times);
  std::vector<CellSums> blocks;
  CellSums all(criteria);
  for (std::uint64_t number = 0; number < kRuns; ++number) {
    MeasuredRun run;
    const RunRows pose = study.run(number);
    for (std::size_t k = 0; k < pose.truth.size(); ++k) {
      run.rows.error.value.push_back(pose.spread.mean[k] - pose.truth[k]);
    }
    run.rows.error.covariance = pose.spread.covariance;
    for (auto& nees : run.rows.error.nees_by)
      nees.assign(study.scans, 3.0 + 0.01 * static_cast<double>(number % 7));
    run.measure(criteria, 0);
    if (number % kRunsOfABlock == 0) blocks.emplace_back(criteria);
    blocks.back().add(run);
    all.add(run);
  }
  for (std::size_t b = 1; b < blocks.size(); ++b) blocks[0].merge(std::move(blocks[b]));
  CellAnalysis merged, whole;
  blocks[0].put(merged);
  all.put(whole);
  EXPECT_EQ(merged.complete, kRuns);
  expect_near(merged, whole);
  const auto &a = merged.get<ConventionHint>(), &b = whole.get<ConventionHint>();
  ASSERT_EQ(a.by_convention.size(), kErrorConventions.size());
  for (std::size_t k = 0; k < a.by_convention.size(); ++k) {
    EXPECT_NEAR(a.by_convention[k].ratio_estimate(), b.by_convention[k].ratio_estimate(), 1e-9);
  }
}

}  // namespace
}  // namespace montecarta::analysis
