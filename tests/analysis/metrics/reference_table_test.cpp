// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_report.hpp"
#include "analysis/metrics/reference_scores.hpp"
#include "analysis/tables/tables.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace montecarta::analysis {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

StudyAnalysis recorded_study(std::size_t steps = 400) {
  const ScratchFolder folder;
  write_recorded_result(folder / "out.h5", 4, steps);
  return analyze(ResultFile(folder / "out.h5"));
}

StudyAnalysis study_with_truth() {
  const ScratchFolder folder;
  write_synthetic_result(folder / "out.h5", 3, 80);
  return analyze(ResultFile(folder / "out.h5"));
}

std::string printed(const StudyAnalysis& study) {
  std::ostringstream out;
  print_tables(out, study, Explanations::shown);
  return out.str();
}

std::vector<std::string> texts_of(const TextTable& table) {
  std::vector<std::string> texts;
  for (const auto& heading : table.headings) texts.push_back(heading.text);
  return texts;
}

/// A filter whose path is where it should be against one that is shifted as a whole.
StudyAnalysis shifted_study(bool has_errors) {
  StudyAnalysis study;
  study.references.push_back({.name = "gps", .times = {1.0}, .fixes = 1, .drives = 1});
  study.references.front().has_errors = has_errors;
  const auto add = [&](const char* filter, double raw, double aligned) {
    CellAnalysis& cell = study.cells.emplace_back();
    cell.label = cell.filter = filter;
    cell.complete = 1;
    ReferenceAnalysis against;
    against.runs.push_back(
        {.rms = raw, .median = raw, .aligned_rms = aligned, .aligned_median = aligned});
    cell.findings.put(ReferenceAnalyses{against});
  };
  add("ekf_slam", 2.37, 0.60);
  add("smoother", 0.67, 0.61);
  return study;
}

// Errors that are known make a reference one in the frame of the drive: a shift is an error.
TEST(ReferenceTable, ComparesAsItStandsWhereTheErrorsOfTheReferenceAreKnown) {
  EXPECT_EQ(baseline_table(shifted_study(true)).rows[1][3], "better in every run");
  EXPECT_EQ(baseline_table(shifted_study(false)).rows[1][3], "better in no run");
}

TEST(ReferenceTable, HasOneRowACellAndReference) {
  const TextTable table = reference_table(recorded_study());
  ASSERT_EQ(table.rows.size(), 8u);
  EXPECT_EQ(table.rows[2][0], "fastslam2_m3");
  EXPECT_EQ(table.rows[2][1], "gps");
  EXPECT_EQ(table.rows[3][1], "coarse");
  EXPECT_EQ(table.rows[0][3], "0 of 4");
  EXPECT_EQ(table.rows[2][3], "1 of 4");  // whose run 1 is 40 m off
  EXPECT_EQ(table.rows[6][2], "1 FAILED, 3 complete");
  EXPECT_EQ(table.rows[6][3], "1 of 4");
  EXPECT_THAT(table.rows[0][9], HasSubstr("(99.0 %)"));
  EXPECT_EQ(table.headings.back().text, "heading RMSE [deg]");
  EXPECT_THAT(table.rows[0].back(), HasSubstr("5.7"));
  EXPECT_EQ(table.rows[1].back(), "-");
}

TEST(BaselineTable, SaysWhoBeatsTheFilterOfTheTextbooksAndWhoLosesTheMap) {
  const TextTable table = baseline_table(recorded_study());
  EXPECT_THAT(texts_of(table),
              ElementsAre("cell", "loses the map", "beats ekf_slam", "against EKF-SLAM"));
  ASSERT_EQ(table.rows.size(), 4u);
  EXPECT_THAT(table.rows[0], ElementsAre("ekf_slam", "0 of 4", "-", "is the baseline"));
  EXPECT_THAT(table.rows[1], ElementsAre("fastslam2_m3", "1 of 4", "0 of 4", "better in no run"));
  EXPECT_THAT(table.rows[2],
              ElementsAre("fastslam2_m20", "0 of 4", "4 of 4", "better in every run"));
  EXPECT_THAT(table.rows[3],
              ElementsAre("ufastslam_m3", "1 of 4", "3 of 4", "better in most runs"));
}

TEST(BaselineTable, NeedsABaseline) {
  StudyAnalysis study = recorded_study();
  study.cells.erase(study.cells.begin());
  EXPECT_THAT(texts_of(baseline_table(study)), ElementsAre("cell", "loses the map"));
  EXPECT_THAT(reference_notes(study), Contains(HasSubstr("no baseline")));
}

TEST(ReferenceTable, SaysNothingByAReferenceWithoutFixesInTheDrive) {
  StudyAnalysis study = recorded_study();
  study.references.front().fixes = 0;
  EXPECT_EQ(reference_table(study).rows[2][3], "-");
  EXPECT_EQ(reference_table(study).rows[3][3], "1 of 4");
  EXPECT_THAT(baseline_table(study).rows, testing::IsEmpty());
  EXPECT_THAT(reference_notes(study), Contains(HasSubstr("No fix of gps lies within the drive")));
}

TEST(ReferenceTable, JudgesDrivesOfTheirOwnByThoseThatHaveFixes) {
  StudyAnalysis study = recorded_study();
  study.own_drives = 4;
  study.references.front().times.clear();
  study.references.front().drives = 3;
  for (CellAnalysis& cell : study.cells) {
    ReferenceAnalyses all = cell.get<ReferenceAnalyses>();
    all.front().runs.front() = {};
    cell.findings.put(all);
  }
  EXPECT_EQ(reference_table(study).rows[2][3], "1 of 3");
  EXPECT_THAT(reference_table(study).rows[2][4], Not(HasSubstr("nan")));
  EXPECT_EQ(baseline_table(study).rows[2][1], "0 of 3");
  EXPECT_THAT(reference_notes(study),
              Contains(HasSubstr("gps has 100 fixes within 3 of 4 drives")));
  EXPECT_THAT(reference_notes(study), Not(Contains(HasSubstr("No fix"))));
}

TEST(MapTable, CountsLandmarksAndBeacons) {
  // Of so many fixes the wild one cannot turn the alignment away.
  const StudyAnalysis study = recorded_study(1200);
  const TextTable table = map_table(study);
  EXPECT_EQ(table.rows[1][1], "20.0 +- 0.0");
  EXPECT_EQ(table.rows[1][2], "3.0 +- 0.0 of 4");
  EXPECT_EQ(table.rows[1][3], "3.30 +- 0.00");
}

TEST(PrintTables, SayOfARecordedDriveWhyThereIsNoVerdict) {
  const std::string text = printed(recorded_study());
  EXPECT_THAT(text, HasSubstr("nobody knows its true path"));
  EXPECT_THAT(text, HasSubstr("aligned RMS [m]"));
  EXPECT_THAT(text, HasSubstr("beats ekf_slam"));
  EXPECT_THAT(text, HasSubstr("gps has 100 fixes within the drive, coarse has 100"));
  EXPECT_THAT(text, Not(HasSubstr("ANEES")));
  EXPECT_THAT(text, Not(HasSubstr("position RMSE")));
}

TEST(PrintTables, OfADriveWithTruthKnowNothingOfReferences) {
  const std::string text = printed(study_with_truth());
  EXPECT_THAT(text, HasSubstr("ANEES"));
  EXPECT_THAT(text, HasSubstr("position RMSE [m]"));
  EXPECT_THAT(text, Not(HasSubstr("aligned")));
  EXPECT_THAT(text, Not(HasSubstr("nobody knows")));
}

}  // namespace
}  // namespace montecarta::analysis
