// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/tables/analysis_file.hpp"
#include "analysis/render/tables/files.hpp"
#include "analysis/render/tables/terminal.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/verdict_table.hpp"
#include "engine/errors.hpp"
#include "engine/records/h5.hpp"
#include "engine/text/number_text.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <fstream>
#include <limits>
#include <sstream>

namespace montecarta::analysis {
namespace {

CellAnalysis consistent_cell() {
  CellAnalysis cell;
  cell.label = "ekf_slam";
  cell.filter = "ekf_slam";
  cell.complete = 30;
  for (const double rmse : {1.87, 1.99}) {
    cell.scores.add(std::vector<ScoreTable::Value>{{"position_rmse", rmse}});
  }
  cell.score_intervals.resize(all_scores().size());
  cell.score_intervals[index_of("position_rmse")] = {1.81, 2.05};
  NeesResult pose;
  pose.series.dimension = 3;
  pose.series.average = {3.0, 3.5};
  pose.series.runs = {30, 30};
  pose.series.bounds.assign(2, nees_bounds(30, 3, 0.95));
  pose.mean = 3.25;
  Member size{.name = "all", .estimate = 1.02, .interval = {0.97, 1.07}};
  size.simultaneous = {0.95, 1.1};
  size.p = 0.4;
  std::vector<FamilyTest> families = {{.family = Family::size, .members = {size}}};
  judge_together(families, 0.95);
  cell.verdict = judge(families, 0.95, 1.1, 30);
  cell.nees = {pose};
  cell.scan_series = {{"position_rmse", "m", {0.1, 0.2}}, {"heading_rmse", "rad", {0.01, 0.02}}};
  return cell;
}

StudyAnalysis small_study() {
  StudyAnalysis study;
  study.study_name = "web_map";
  study.study_runs = study.runs_here = 30;
  study.times = {0.2, 0.4};
  study.duration = 0.4;
  CellAnalysis broken;
  broken.label = "fastslam2_m30";
  broken.missing = 3;
  broken.failures = {{7, 120, "weights, all of them, are zero"}};
  broken.verdict.runs = broken.verdict.failed = 1;
  study.cells = {consistent_cell(), broken};
  return study;
}

TEST(NumberText, IsShortAndSaysWhatItMeasured) {
  EXPECT_EQ(readable(3.14159), "3.14");
  EXPECT_EQ(readable(152.37), "152");
  EXPECT_EQ(readable(15237.0), "15237");
  EXPECT_EQ(readable(0.0123456), "0.0123");
  EXPECT_EQ(readable(0.0), "0.00");
  EXPECT_EQ(readable(2.5e9), "2.5e+09");
  EXPECT_EQ(readable(kNaN), "-");
  EXPECT_EQ(compact(9999.0), "9999");
  EXPECT_EQ(compact(272632.0), "2.73e5");
  EXPECT_EQ(compact(kNaN), "-");
  EXPECT_EQ(with_error(3.5812, 0.1049), "3.58 +- 0.10");
  EXPECT_EQ(with_error(3.5812, kNaN), "3.58");
  EXPECT_EQ(with_error(3.5812, std::numeric_limits<double>::infinity()), "3.58");
  EXPECT_EQ(with_error(1234.5, 56.7), "1234 +- 57");
  EXPECT_EQ(with_error_to(2, 3.5812, 0.0001), "3.58 +- 0.00");
  EXPECT_EQ(with_error_to(1, 242.31, kNaN), "242.3");
  EXPECT_EQ(with_error_to(2, kNaN, kNaN), "-");
  EXPECT_EQ(with_interval(3.5812, {3.3791, 3.7902}), "3.58 [3.38, 3.79]");
  EXPECT_EQ(with_interval(3.5812, {kNaN, kNaN}), "3.58");
  EXPECT_EQ(with_interval(272632.0, {1.0, 500000.0}), "2.73e5 [1.00, 5.00e5]");
  EXPECT_EQ(with_interval(3.58e-14, {3.3e-14, 3.8e-14}), "3.6e-14 [3.3e-14, 3.8e-14]");
  EXPECT_EQ(with_interval(-0.0002, {-0.04, 0.04}), "0.000 [-0.040, 0.040]");
  EXPECT_EQ(ratio_with_interval(1.9621, {1.612, 24.21}), "1.96 [1.61, 24.21]");
  EXPECT_EQ(ratio_with_interval(0.9162, {0.828, 1.052}), "0.916 [0.828, 1.052]");
  EXPECT_EQ(ratio_with_interval(1.00312, {0.99811, 1.00812}), "1.0031 [0.9981, 1.0081]");
  EXPECT_EQ(ratio_with_interval(182.3, {160.2, 216.8}), "182 [160, 217]");
  EXPECT_EQ(ratio_with_interval(0.0, {0.0, 0.5}), "0.00 [0.00, 0.50]");
  EXPECT_EQ(percent(0.9456), "94.6 %");
  EXPECT_EQ(level_text(0.95), "95 %");
  EXPECT_EQ(level_text(0.999), "99.9 %");
  EXPECT_EQ(std::stod(exact_text(0.1 + 0.2)), 0.1 + 0.2);
}

TEST(PrintSummary, PutsFailedRunsFirstThenSentencesThenOneTable) {
  std::ostringstream out;
  print_summary(out, small_study(), 80);
  const std::string text = out.str();
  const std::size_t failures = text.find("weights, all of them"),
                    sentence = text.find("ekf_slam is consistent"), table = text.find("NEES ratio");
  EXPECT_LT(failures, sentence);
  EXPECT_LT(sentence, table);
  EXPECT_NE(table, std::string::npos);
  EXPECT_EQ(text.find("NEES ratio", table + 1), std::string::npos);
}

TEST(PrintSummary, LeavesOutColumnsWithoutNumbers) {
  const TextTable table = summary_table(small_study());
  for (const TextTable::Heading& heading : table.headings) EXPECT_NE(heading.text, "ancestors");
  EXPECT_EQ(table.rows.size(), 2u);
}

TEST(PrintAll, HasEveryTableInTheWidthOfTheTerminal) {
  std::ostringstream out;
  print_all(out, small_study(), 80);
  EXPECT_THAT(out.str(), HasSubstr("1.93 [1.81, 2.05]"));
  std::istringstream lines(out.str());
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
}

TEST(PrintNamed, PrintsATableWithItsNotesOrSaysWhichThereAre) {
  std::ostringstream out;
  print_named(out, small_study(), "accuracy", 80);
  EXPECT_THAT(out.str(), HasSubstr("position RMSE"));
  EXPECT_THAT(out.str(), HasSubstr("\n\n"));
  try {
    print_named(out, small_study(), "acuracy", 80);
    FAIL();
  } catch (const StudyError& error) {
    EXPECT_THAT(error.what(), HasSubstr("accuracy"));
  }
}

TEST(WriteCsv, WritesOneRowACellAndOneRowAScan) {
  const ScratchFolder folder;
  write_csv(small_study(), folder / "csv");
  EXPECT_THAT(text_in(folder / "csv/cells.csv"),
              HasSubstr("\nekf_slam,ekf_slam,consistent within 1.1,0,30,0"));
  EXPECT_THAT(text_in(folder / "csv/consistency.csv"),
              HasSubstr("ekf_slam,pose,spread,0.95,3,3.25"));
  EXPECT_THAT(text_in(folder / "csv/failures.csv"),
              HasSubstr("fastslam2_m30,7,120,\"weights, all of them, are zero\""));
  const std::string series = text_in(folder / "csv/series_ekf_slam.csv");
  EXPECT_THAT(series, testing::StartsWith("time [s],position_rmse [m],heading_rmse [rad],anees"));
  EXPECT_THAT(series, HasSubstr("\n0.4,0.2,0.02,3.5,"));
}

TEST(WriteCsv, NamesTheFileItCannotWrite) {
  const ScratchFolder folder;
  std::ofstream(folder / "taken") << "a file";
  EXPECT_THROW(write_csv(small_study(), folder / "taken"), RunError);
  EXPECT_THROW(write_text("/dev/full", std::string(100'000, 'x')), RunError);
}

TEST(Latex, EscapesTextAndHasOneRowACell) {
  EXPECT_EQ(latex_escape("fastslam2_m30 & 5 % #1 $x$ {y}"),
            "fastslam2\\_m30 \\& 5 \\% \\#1 \\$x\\$ \\{y\\}");
  EXPECT_EQ(latex_escape("~^\\<>"),
            "\\textasciitilde{}\\textasciicircum{}\\textbackslash{}\\textless{}\\textgreater{}");
  EXPECT_EQ(latex_escape("3.58 +- 0.10"), "3.58 $\\pm$ 0.10");
  TextTable table;
  table.headings = {{"", Align::left}, {"RMSE [m]"}};
  table.rows = {{"a_b", "1 +- 2"}, {"", "3"}};
  EXPECT_EQ(latex_tabular(table),
            "\\begin{tabular}{lr}\n\\toprule\n & RMSE [m] \\\\\n\\midrule\n"
            "a\\_b & 1 $\\pm$ 2 \\\\\n & 3 \\\\\n\\bottomrule\n\\end{tabular}\n");
  StudyAnalysis study = small_study();
  study.study_name = "a\n\\input{/etc/passwd}";
  const std::string latex = latex_table(study, {});
  EXPECT_EQ(latex.find("\\begin{tabular}"), latex.find('\n') + 1);
}

TEST(WriteAnalysisFile, HoldsSeriesAndVerdicts) {
  const ScratchFolder folder;
  write_analysis_file(small_study(), folder / "analysis.h5");
  const auto file = h5::open_file(folder / "analysis.h5");
  EXPECT_EQ(h5::text(file, "filetype"), "montecarta-analysis");
  const auto cell = h5::open_group(file, "cells/ekf_slam");
  EXPECT_EQ(h5::text(cell, "verdict"), "consistent within 1.1");
  std::vector<double> values(2);
  h5::read(h5::open_dataset(file, "cells/ekf_slam/series/anees_pose_spread"), Element::f64,
           std::as_writable_bytes(std::span(values)));
  EXPECT_THAT(values, ElementsAre(3.0, 3.5));
  EXPECT_EQ(h5::text(h5::open_group(file, "cells/fastslam2_m30"), "verdict"),
            "not tested (1 of 1 runs failed)");
}

TEST(WriteAnalysisFile, HoldsEveryTestOfTheVerdict) {
  const ScratchFolder folder;
  StudyAnalysis study = small_study();
  Member x, heading;
  x.name = "x", x.p = 0.5, heading.name = "heading", heading.p = 0.001;
  study.cells[0].verdict.families = {{.family = Family::component, .members = {x, heading}}};
  write_analysis_file(study, folder / "analysis.h5");
  const auto file = h5::open_file(folder / "analysis.h5");
  const std::string group = "cells/ekf_slam/families/component";
  EXPECT_EQ(h5::text(h5::open_group(file, group), "members"), "x\nheading");
  std::vector<double> p(2);
  h5::read(h5::open_dataset(file, group + "/p"), Element::f64,
           std::as_writable_bytes(std::span(p)));
  EXPECT_THAT(p, ElementsAre(0.5, 0.001));
}

}  // namespace
}  // namespace montecarta::analysis
