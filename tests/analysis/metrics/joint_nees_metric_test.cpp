// SPDX-License-Identifier: BSD-3-Clause

#include "analysis/metrics/joint_nees.hpp"
#include "analysis/tables/tables.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/doubles/csv_table.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

StudyAnalysis study_of_two() {
  StudyAnalysis study;
  study.joint_times = {5.0, 10.0};
  CellAnalysis judged, without;
  judged.label = "ekf_slam";
  judged.complete = 20;
  JointConsistency joint;
  joint.stored = true;
  joint.average = {0.5, 1.2};
  joint.bounds = {{0.9, 1.1}, {0.95, 1.05}};
  joint.dimension = {7.0, 9.5};
  joint.runs = {20, 19};
  joint.samples = 40;
  joint.undefined = 1;
  joint.verdict = Verdict::optimistic;
  joint.highest_row = 1;
  joint.lowest_row = 0;
  judged.findings.put(joint);
  without.label = "fastslam2_m100";
  study.cells = {judged, without};
  return study;
}

TEST(JointTable, HasARowForACellThatWasJudged) {
  const TextTable table = reported_table(study_of_two(), "joint_nees");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_THAT(table.rows[0],
              ElementsAre("ekf_slam", "9.50", "1.20", "[0.950, 1.05]", "0.500 at 5.00 s",
                          "optimistic by 1.14 to 1.26 at 10.0 s"));
}

TEST(JointTable, IsFarthestWhereThereIsANumber) {
  StudyAnalysis study = study_of_two();
  JointConsistency joint = study.cells[0].get<JointConsistency>();
  joint.average[0] = std::numeric_limits<double>::quiet_NaN();
  study.cells[0].findings.put(joint);
  EXPECT_EQ(reported_table(study, "joint_nees").rows[0][4], "1.20 at 10.0 s");
}

TEST(JointTable, SaysWhatWasLeftOut) {
  StudyAnalysis study = study_of_two();
  EXPECT_THAT(reported_notes(study, "joint_nees"),
              ElementsAre(HasSubstr("all 2 stored scans"), HasSubstr("of 40 joint covariances 1")));
  study.cells[0].findings.put(JointConsistency{});
  EXPECT_THAT(reported_notes(study, "joint_nees"), IsEmpty());
  EXPECT_THAT(reported_table(study, "joint_nees").rows, IsEmpty());
  EXPECT_THAT(reported_figure(study, "joint_nees").data, IsEmpty());
  JointConsistency unjudged;
  unjudged.missing = "nobody knows";
  study.cells[0].findings.put(unjudged);
  EXPECT_THAT(reported_notes(study, "joint_nees"),
              ElementsAre(HasSubstr("ekf_slam: pose and map together are not")));
}

TEST(JointTable, HasEveryNumberAsCsv) {
  const ScratchFolder folder;
  write_csv(study_of_two(), folder.path());
  auto rows = read_csv(folder / "joint_nees.csv");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1]["nees_per_component"], "1.2");
  EXPECT_EQ(rows[1]["runs"], "19");
}

TEST(JointFigure, ShowsTheCellAndItsBand) {
  const Figure figure = reported_figure(study_of_two(), "joint_nees");
  ASSERT_EQ(figure.data.size(), 1u);
  EXPECT_EQ(figure.data[0].rows.size(), 2u);
  EXPECT_EQ(figure.data[0].rows[0].size(), 4u) << "time, the cell, both ends of the band";
}

}  // namespace
}  // namespace montecarta::analysis
