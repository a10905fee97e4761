// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/sweep.hpp"

#include "analysis/render/figures/gnuplot.hpp"
#include "analysis/render/page/page.hpp"
#include "analysis/statistics/spread.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/doubles/matchers.hpp"

#include <array>

namespace montecarta::analysis {
namespace {

using Options = std::vector<std::pair<std::string, std::string>>;
using testing::ElementsAre;
using testing::IsEmpty;

/// A cell of two runs with this mean position RMSE.
CellAnalysis swept_cell(const std::string& filter, const Options& settings, double rmse = 1.0) {
  CellAnalysis cell;
  cell.label = filter + std::to_string(rmse);
  cell.filter = filter;
  cell.settings = settings;
  for (const double one : {rmse - 0.1, rmse + 0.1}) {
    const std::array values{ScoreTable::Value{"position_rmse", one}};
    cell.scores.add(values);
  }
  cell.complete = 2;
  cell.score_intervals.assign(all_scores().size(), {rmse - 0.5, rmse + 0.5});
  return cell;
}

StudyAnalysis swept_study(std::vector<CellAnalysis> cells) {
  StudyAnalysis study;
  study.cells = std::move(cells);
  return study;
}

StudyAnalysis with_particles(const std::vector<std::string>& numbers) {
  std::vector<CellAnalysis> cells;
  for (const char* mode : {"one", "two"}) {
    for (const std::string& particles : numbers)
      cells.push_back(swept_cell("pf", {{"particles", particles}, {"mode", mode}},
                                 100.0 / std::stod(particles)));
  }
  cells.push_back(swept_cell("kf", {{"iterations", "0"}}));
  return swept_study(cells);
}

TEST(Sweeps, AreCurvesOfCellsThatDifferInOneNumber) {
  const StudyAnalysis study = with_particles({"20", "5", "100"});
  const std::vector<Sweep> sweeps = sweeps_of(study);
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].option, "particles");
  EXPECT_THAT(sweeps[0].values, ElementsAre("5", "20", "100"));
  ASSERT_EQ(sweeps[0].curves.size(), 2U);
  EXPECT_EQ(sweeps[0].curves[0].name, "pf mode=one");
  EXPECT_THAT(sweeps[0].curves[0].cells,
              ElementsAre(&study.cells[1], &study.cells[0], &study.cells[2]));
}

TEST(Sweeps, NeedThreeValues) {
  EXPECT_THAT(sweeps_of(with_particles({"20", "5"})), IsEmpty());
  EXPECT_THAT(sweeps_of(swept_study({})), IsEmpty());
}

TEST(Sweeps, AreNotOfCellsThatDifferInTwoNumbers) {
  std::vector<CellAnalysis> cells;
  for (const char* value : {"1", "2", "3", "4"})
    cells.push_back(swept_cell("pf", {{"particles", value}, {"generations", value}}));
  EXPECT_THAT(sweeps_of(swept_study(cells)), IsEmpty());
}

TEST(Sweeps, AreOfNumbersOnly) {
  std::vector<CellAnalysis> cells;
  for (const char* value : {"best", "random", "2nd"})
    cells.push_back(swept_cell("pf", {{"base", value}}));
  EXPECT_THAT(sweeps_of(swept_study(cells)), IsEmpty());
}

TEST(Sweeps, TakeAFactorThatIsNotStoredForOne) {
  const std::vector<Sweep> sweeps =
      sweeps_of(swept_study({swept_cell("kf", {}), swept_cell("kf", {{"motion_noise", "0.5"}}),
                             swept_cell("kf", {{"motion_noise", "2"}})}));
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_THAT(sweeps[0].values, ElementsAre("0.5", "1", "2"));
  EXPECT_EQ(sweeps[0].curves[0].name, "kf");
}

TEST(Sweeps, LeaveAGapWhereThereIsNoCell) {
  StudyAnalysis study = with_particles({"5", "20", "100"});
  study.cells.erase(study.cells.begin() + 1);
  const std::vector<Sweep> sweeps = sweeps_of(study);
  EXPECT_EQ(sweeps.at(0).curves.at(0).cells.at(1), nullptr);
  EXPECT_NE(sweeps.at(0).curves.at(1).cells.at(1), nullptr);
}

TEST(SweepFigure, HasPointsWithIntervalsAtTheValues) {
  const StudyAnalysis study = with_particles({"5", "20", "100"});
  const Figure figure = reported_figure(study, "sweep_particles");
  EXPECT_THAT(figure.chart.x_names, ElementsAre("5", "20", "100"));
  ASSERT_EQ(figure.chart.panels.size(), 1U) << "only what the cells have";
  const ChartMarks& points = figure.chart.panels[0].marks.at(2);
  EXPECT_EQ(points.cell, "pf mode=one");
  EXPECT_THAT(points.x, ElementsAre(0.0, 1.0, 2.0));
  EXPECT_THAT(points.y, ElementsAre(20.0, 5.0, 1.0));
  EXPECT_THAT(points.facts.at(1).values, ElementsAre(19.5, 4.5, 0.5));
  EXPECT_TRUE(figure.chart.panels[0].axis.logarithmic);
  const std::string commands = gnuplot_chart(figure.chart, 900).commands;
  EXPECT_THAT(commands, HasSubstr("set xtics nomirror ('5' 0, '20' 1, '100' 2)"));
  EXPECT_THAT(commands, HasSubstr("title 'pf mode=one'"));
}

TEST(SweepFigure, LeadsTheSummaryOfAStudyThatVariesAnOption) {
  const StudyAnalysis study = with_particles({"5", "20", "100"});
  Section varied{"sweep", ""}, nees{"nees", ""};
  varied.figures = {reported_figure(study, "sweep_particles")};
  nees.figures = {varied.figures[0]};
  nees.figures[0].name = "anees";
  const auto page = [&](const std::vector<Section>& sections) {
    return markdown_page(study, sections, {});
  };
  EXPECT_THAT(page({varied, nees}), HasSubstr("](figures/sweep_particles.svg)"));
  EXPECT_THAT(page({varied, nees}), testing::Not(HasSubstr("](figures/anees.svg)")));
  EXPECT_THAT(page({nees}), HasSubstr("](figures/anees.svg)"));
}

TEST(SweepTable, HasARowForEachCellOfACurve) {
  const TextTable table = reported_table(with_particles({"5", "20", "100"}), "sweep");
  ASSERT_EQ(table.rows.size(), 6U);
  EXPECT_EQ(table.rows[0].at(0), "pf mode=one");
  EXPECT_EQ(table.rows[0].at(1), "5");
  EXPECT_THAT(table.rows[0].at(2), testing::StartsWith("20.0"));
  EXPECT_TRUE(reported_table(with_particles({"5", "20"}), "sweep").rows.empty());
}

}  // namespace
}  // namespace montecarta::analysis
