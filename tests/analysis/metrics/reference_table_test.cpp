// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/page.hpp"
#include "analysis/render/tables/analysis_file.hpp"
#include "analysis/render/tables/files.hpp"
#include "analysis/run/reference_scores.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "engine/records/h5.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>

#include <algorithm>

namespace montecarta::analysis {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// The result of recorded_result.hpp, analysed once for all tests of this file.
const StudyAnalysis& recorded_study() {
  static const StudyAnalysis study = [] {
    const ScratchFolder folder;
    // With so many fixes the wild one cannot turn the alignment away.
    write_recorded_result(folder / "out.h5", 4, 1200);
    return analyze(ResultFile(folder / "out.h5"));
  }();
  return study;
}

/// The table of this name in the section on references; without rows where there is none.
TextTable table_of(const StudyAnalysis& study, const std::string& name) {
  for (const auto& one : reported_section(study, "references").all<Section::Table>()) {
    if (one.name == name) return one.table;
  }
  return {};
}
TextTable reference_table(const StudyAnalysis& study) { return table_of(study, "reference"); }
TextTable baseline_table(const StudyAnalysis& study) { return table_of(study, "baseline"); }
TextTable map_table(const StudyAnalysis& study) { return table_of(study, "map"); }
std::vector<std::string> reference_notes(const StudyAnalysis& study) {
  return reported_notes(study, "references");
}

std::vector<std::string> texts_of(const TextTable& table) {
  std::vector<std::string> texts;
  for (const auto& heading : table.headings) texts.push_back(heading.text);
  return texts;
}

/// A filter with the right path against one with a path that is shifted as a whole.
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

TEST(ReferencePage, BeginsWithTheNearestCellByTheDistanceThatIsCompared) {
  StudyAnalysis study = shifted_study(true);
  study.has_truth = false;
  EXPECT_THAT(
      markdown_page(study, {}, {}),
      HasSubstr("\n\nOf 2 cells (a cell is a filter in one setting), smoother is the nearest "
                "to the reference gps, with an RMS distance of 0.670 m"));
  study.references.front().has_errors = false;
  EXPECT_THAT(markdown_page(study, {}, {}), HasSubstr("ekf\\_slam is the nearest to"));
}

TEST(ReferencePage, BeginsWithTheVerdictByTheReferenceIfItsErrorsAreKnown) {
  StudyAnalysis study = shifted_study(true);
  study.has_truth = false;
  const auto judge = [&](CellAnalysis& cell, Answer answer, double ratio) {
    DriveConsistency drive;
    drive.answer = answer;
    drive.mean.blocks[static_cast<std::size_t>(drive.mean.leading)].mean = ratio;
    cell.findings.put(DriveConsistencies{drive});
  };
  judge(study.cells[0], Answer::optimistic, 2.5);
  judge(study.cells[1], Answer::consistent, 1.02);
  EXPECT_THAT(markdown_page(study, {}, {}),
              HasSubstr("\n\nOf 2 cells (a cell is a filter in one setting), judged by gps, 1 is "
                        "consistent within 1.1: smoother (NEES / expected 1.02); 1 is optimistic: "
                        "ekf\\_slam (NEES / expected 2.50). Of these, smoother is the nearest"));
  study.cells.resize(1);
  EXPECT_THAT(markdown_page(study, {}, {}),
              HasSubstr("\n\nJudged by gps, ekf\\_slam is optimistic (NEES / expected 2.50). One"));
}

TEST(ReferencePage, NamesNoNearestCellAmongEqualOnes) {
  StudyAnalysis study = shifted_study(true);
  study.has_truth = false;
  study.cells[1] = study.cells[0];
  EXPECT_THAT(markdown_page(study, {}, {}), Not(HasSubstr("nearest")));
}

TEST(ReferencePage, NamesNoNearestCellWhereRunsFailed) {
  StudyAnalysis study = shifted_study(true);
  study.has_truth = false;
  study.cells[1].failures.emplace_back();
  EXPECT_THAT(markdown_page(study, {}, {}), Not(HasSubstr("nearest")));
}

TEST(StudyPage, OfOneCellBeginsWithItsAnswer) {
  StudyAnalysis study = shifted_study(true);
  study.references.clear();
  study.has_truth = true;
  study.cells.resize(1);
  study.cells[0].verdict.answer = Answer::optimistic;
  EXPECT_THAT(markdown_page(study, {}, {}),
              HasSubstr("\n\nekf\\_slam is slightly optimistic. Where"));
}

TEST(BaselineTable, PrintsEqualResultsAsTies) {
  StudyAnalysis study = shifted_study(true);
  study.cells[1].findings.put(study.cells[0].get<ReferenceAnalyses>());
  EXPECT_THAT(baseline_table(study).rows[1],
              ElementsAre("smoother", "0 of 1", "0 of 1, 1 tie", "equal in every run"));
}

TEST(ReferenceTable, HasOneRowACellAndReference) {
  const TextTable table = reference_table(recorded_study());
  ASSERT_EQ(table.rows.size(), 8u);
  EXPECT_EQ(table.rows[2][0], "fastslam2_m3");
  EXPECT_EQ(table.rows[2][1], "gps");
  EXPECT_EQ(table.rows[3][1], "coarse");
  EXPECT_EQ(table.rows[0][3], "0 of 4");
  EXPECT_EQ(table.rows[2][3], "1 of 4");  // run 1 is 40 m off
  EXPECT_EQ(table.rows[6][2], "1 FAILED, 3 complete");
  EXPECT_EQ(table.rows[6][3], "1 of 4");
  EXPECT_THAT(table.rows[0][9], HasSubstr("(99.7 %)"));
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
              Contains(HasSubstr("gps has 300 fixes within 3 of 4 drives")));
  EXPECT_THAT(reference_notes(study), Not(Contains(HasSubstr("No fix"))));
}

TEST(MapTable, CountsLandmarksAndBeacons) {
  const TextTable table = map_table(recorded_study());
  EXPECT_EQ(table.rows[1][1], "20.0 +- 0.0");
  EXPECT_EQ(table.rows[1][2], "3.0 +- 0.0 of 4");
  EXPECT_EQ(table.rows[1][3], "3.30 +- 0.00");
}

/// A cell of two runs with the raw and aligned RMS `rms` and 1.5 times that [m].
CellAnalysis cell_of(const std::string& label, const std::string& filter, std::size_t particles,
                     double rms) {
  CellAnalysis cell;
  cell.label = label;
  cell.filter = filter;
  cell.particles = particles;
  cell.complete = 2;
  ReferenceAnalysis gps;
  for (const double value : {rms, 1.5 * rms}) {
    ReferenceScores run;
    run.rms = run.aligned_rms = value;
    gps.runs.push_back(run);
  }
  gps.error_over_time = {rms, 2.0 * rms, rms};
  cell.findings.put(ReferenceAnalyses{gps});
  cell.scan_series = {{"map_landmarks", "1", {3.0, 4.0}}};
  return cell;
}

StudyAnalysis study_of(const std::vector<CellAnalysis>& cells) {
  StudyAnalysis study;
  study.has_truth = false;
  study.times = {1.0, 2.0};
  study.references = {{"gps", {0.5, 1.0, 1.5}, 3, 1, false}};
  study.cells = cells;
  return study;
}

std::vector<std::string> names_of(const std::vector<Figure>& figures) {
  std::vector<std::string> names;
  for (const Figure& figure : figures) names.push_back(figure.name);
  return names;
}

std::vector<Figure> reference_figures(const StudyAnalysis& study) {
  std::vector<Figure> figures;
  for (const Figure& figure : figures_of(study)) {
    if (figure.name == "reference_error" || figure.name == "map_size") figures.push_back(figure);
  }
  return figures;
}

TEST(ReferenceFigures, ShowErrorsParticlesAndMaps) {
  const auto figures = reference_figures(study_of({cell_of("ekf_slam", "ekf_slam", 0, 1.0),
                                                   cell_of("fastslam2_m20", "fastslam2", 20, 2.0),
                                                   cell_of("fastslam2_m3", "fastslam2", 3, 4.0)}));
  EXPECT_THAT(names_of(figures), ElementsAre("reference_error", "map_size"));
  EXPECT_EQ(figures[0].data[0].frame.columns[0].numbers[1], 1.0);  // over the times of the fixes
  EXPECT_EQ(figures[0].data[0].frame.columns[3].numbers[1], 8.0);
}

TEST(ReferenceFigures, SpreadManyCellsOverAPanelForEachNumberOfParticles) {
  std::vector<CellAnalysis> cells = {cell_of("ekf_slam", "ekf_slam", 0, 1.0)};
  for (const std::string filter : {"a", "b", "c", "d"}) {
    cells.push_back(cell_of(filter + "_m3", filter, 3, 2.0));
    if (filter != "b") cells.push_back(cell_of(filter + "_m20", filter, 20, 3.0));
  }
  EXPECT_EQ(reported_figure(study_of(cells), "reference_error").data.size(),
            1u);  // eight are told apart
  cells.push_back(cell_of("e_m20", "e", 20, 5.0));
  const Figure figure = reported_figure(study_of(cells), "reference_error");
  ASSERT_EQ(figure.data.size(), 2u);
  EXPECT_EQ(figure.data[0].name, "reference_error_m3.csv");
  std::vector<std::string> names;
  for (const Frame::Column& column : figure.data[1].frame.columns) names.push_back(column.name);
  EXPECT_THAT(names, ElementsAre("time [s]", "ekf_slam", "a", "b", "c", "d", "e"));
  EXPECT_THAT(row_of(figure.data[1].frame, 0),
              ElementsAre(0.5, 1.0, 3.0, testing::IsNan(), 3.0, 3.0, 5.0));
  EXPECT_THAT(row_of(figure.data[0].frame, 0),
              ElementsAre(0.5, 1.0, 2.0, 2.0, 2.0, 2.0, testing::IsNan()));
  EXPECT_EQ(figure.chart.panels[1].label, "distance to gps [m], M = 20");
}

TEST(ReferenceFigures, AreNotDrawnWithoutReferences) {
  StudyAnalysis study = study_of({cell_of("a", "a", 0, 1.0)});
  study.references.clear();
  study.cells[0].findings.put(ReferenceAnalyses{});
  study.cells[0].scan_series.clear();
  EXPECT_THAT(reference_figures(study), IsEmpty());
}

class ReferenceFiles : public ::testing::Test {
 protected:
  ScratchFolder folder_;
  StudyAnalysis study_ = recorded_study();
};

TEST_F(ReferenceFiles, HoldARowForEachCellAndReferenceAndForEachFix) {
  write_csv(study_, folder_ / "csv");
  const std::string rows = text_in(folder_ / "csv/references.csv");
  EXPECT_THAT(rows, StartsWith("cell,filter,reference,runs_failed,runs_complete,runs_lost,"
                               "rms_mean [m],rms_standard_error [m],rms_median [m],"
                               "rms_least [m],rms_greatest [m],"));
  EXPECT_EQ(std::ranges::count(rows, '\n'), 9);
  EXPECT_THAT(rows, HasSubstr("\nufastslam_m3,ufastslam,coarse,1,3,1,"));
  EXPECT_THAT(rows, HasSubstr("beacons_found_mean"));
  const std::string errors = text_in(folder_ / "csv/reference_errors.csv");
  EXPECT_THAT(errors, StartsWith("time [s],ekf_slam [m],fastslam2_m3 [m],"));
  EXPECT_EQ(std::ranges::count(errors, '\n'), 301);
  EXPECT_THAT(text_in(folder_ / "csv/series_ekf_slam.csv"),
              StartsWith("time [s],map_landmarks,nis_per_component,nis_lower,nis_upper\n"));
  const auto names = csv_names({"ekf_slam"});
  EXPECT_THAT(names, testing::IsSupersetOf({"references.csv", "reference_errors.csv"}));
}

TEST_F(ReferenceFiles, AreNotThereWhereTheTruthIsKnown) {
  write_synthetic_result(folder_ / "true.h5", 3, 80);
  write_csv(analyze(ResultFile(folder_ / "true.h5")), folder_ / "csv");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "csv/references.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "csv/reference_errors.csv"));
  EXPECT_THAT(text_in(folder_ / "csv/cells.csv"), Not(HasSubstr("reference")));
  const std::string series = text_in(folder_ / "csv/series_scripted_m4.csv");
  EXPECT_THAT(series, StartsWith("time [s],position_rmse [m],heading_rmse [rad],anees"));
  EXPECT_THAT(series, Not(HasSubstr("map_landmarks")));
}

TEST_F(ReferenceFiles, AreGroupsOfTheAnalysisFile) {
  study_.references[1].fixes = 0;
  study_.references[1].times.clear();  // as if no fix lay within the drive
  write_analysis_file(study_, folder_ / "analysis.h5");
  const auto file = h5::open_file(folder_ / "analysis.h5");
  const std::string group = "cells/fastslam2_m20/references/";
  std::vector<double> errors(300), mean(1);
  h5::read(h5::open_dataset(file, group + "gps/error_over_time"), Element::f64,
           std::as_writable_bytes(std::span(errors)));
  EXPECT_EQ(errors, study_.cells[2].get<ReferenceAnalyses>()[0].error_over_time);
  h5::read(h5::open_dataset(file, group + "gps/aligned_rms_mean"), Element::f64,
           std::as_writable_bytes(std::span(mean)));
  EXPECT_EQ(mean[0], study_.cells[2]
                         .get<ReferenceAnalyses>()[0]
                         .over_runs(&ReferenceScores::aligned_rms)
                         .summary.mean);
  EXPECT_FALSE(h5::has(h5::open_group(file, group + "coarse"), "error_over_time"));
  EXPECT_EQ(h5::text(h5::open_group(file, "cells/ekf_slam"), "verdict"), "not tested");
}

}  // namespace
}  // namespace montecarta::analysis
