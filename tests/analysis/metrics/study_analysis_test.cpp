// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/study_analysis.hpp"

#include "engine/errors.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

class StudyAnalysisOfAFile : public ::testing::Test {
 protected:
  void SetUp() override { write_synthetic_result(path_); }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

TEST_F(StudyAnalysisOfAFile, JudgesEveryCellAndNamesFailedRuns) {
  const StudyAnalysis study = analyze(ResultFile(path_));
  ASSERT_EQ(study.cells.size(), 2u);
  EXPECT_EQ(study.times.size(), 100u);
  EXPECT_EQ(study.cells[0].complete, 12u);
  EXPECT_EQ(study.cells[0].leading, Moments::corrected);
  EXPECT_EQ(study.cells[0].consistency().verdict, Verdict::undecided) << "of 12 runs";
  EXPECT_EQ(
      analyze(ResultFile(path_), 0.95, Parallel::serial(), 1.5).cells[0].consistency().verdict,
      Verdict::consistent);
  EXPECT_EQ(study.cells[1].consistency().verdict, Verdict::optimistic);
  ASSERT_EQ(study.cells[1].failures.size(), 1u);
  EXPECT_EQ(study.cells[1].complete, 11u);
  EXPECT_EQ(study.cells[1].failures[0].run, 11u);
  EXPECT_EQ(study.cells[1].failures[0].step, 5u);
  EXPECT_EQ(study.cells[1].failures[0].reason, "gain is <not> a number & worse");
  EXPECT_TRUE(study.has_failures());
  EXPECT_NEAR(study.cells[1].over_runs("position_mse").mean,
              9.0 * study.cells[0].over_runs("position_mse").mean, 0.5);
}

/// An index that is none: the message names file, cell and run.
TEST_F(StudyAnalysisOfAFile, RefusesAncestorsThatAreNoParticles) {
  const auto spoil = [](std::size_t cell, std::uint64_t run, RunRecord& record) {
    if (cell != 1 || run != 7) return;
    record.column<std::uint16_t>(*record.layout().find("ancestor")).back() = 3;  // of 0, 1 and 2
  };
  write_synthetic_result(path_, 12, 40, spoil);
  try {
    analyze(ResultFile(path_));
    FAIL() << "an ancestor that is no particle was taken";
  } catch (const StudyError& error) {
    EXPECT_EQ(std::string(error.what()).find(path_.string() + ": cell 'scripted_m3', run 7: "), 0U)
        << error.what();
  }
}

TEST_F(StudyAnalysisOfAFile, GivesTheSameBitsForAnyNumberOfThreads) {
  const ResultFile file(path_);
  const StudyAnalysis one = analyze(file);
  const StudyAnalysis many = analyze(file, 0.95, Parallel(Backend::tbb, 3));
  for (std::size_t c = 0; c < one.cells.size(); ++c) {
    for (std::size_t i = 0; i < one.cells[c].nees.size(); ++i) {
      EXPECT_EQ(one.cells[c].nees[i].series.average, many.cells[c].nees[i].series.average);
    }
    EXPECT_EQ(one.cells[c].over_runs("position_rmse").mean,
              many.cells[c].over_runs("position_rmse").mean);
    EXPECT_EQ(one.cells[c].over_runs("position_rmse").sd,
              many.cells[c].over_runs("position_rmse").sd);
  }
}

TEST_F(StudyAnalysisOfAFile, RefusesAWrongLevel) {
  EXPECT_THROW(analyze(ResultFile(path_), 95.0), StudyError);
}

}  // namespace
}  // namespace montecarta::analysis
