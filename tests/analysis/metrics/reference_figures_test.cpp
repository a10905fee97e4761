// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/particle_curves.hpp"
#include "analysis/metrics/reference_report.hpp"
#include "analysis/metrics/reference_scores.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

/// A cell of two runs whose raw and aligned RMS are `rms` and 1.5 times that [m].
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

TEST(ReferenceFigures, ShowErrorsParticlesAndMaps) {
  const auto figures = reference_figures(study_of({cell_of("ekf_slam", "ekf_slam", 0, 1.0),
                                                   cell_of("fastslam2_m20", "fastslam2", 20, 2.0),
                                                   cell_of("fastslam2_m3", "fastslam2", 3, 4.0)}));
  EXPECT_THAT(names_of(figures), ElementsAre("reference_error", "reference_particles", "map_size"));
  EXPECT_EQ(figures[0].data[0].rows[1][0], 1.0);  // over the times of the fixes
  EXPECT_EQ(figures[0].data[0].rows[1][3], 8.0);
  const FigureData& curve = figures[1].data.at(0);
  EXPECT_EQ(curve.name, "rms_fastslam2.csv");
  ASSERT_EQ(curve.rows.size(), 2u);
  EXPECT_EQ(curve.rows[0][0], 3.0);
  EXPECT_EQ(curve.rows[0][2], 5.0);
  EXPECT_EQ(curve.rows[0][5], 4.0);
  EXPECT_EQ(curve.rows[1][11], 3.0);
  EXPECT_EQ(figures[1].chart.panels.at(0).curves.back().legend, "EKF-SLAM");
}

TEST(ReferenceFigures, DrawParticlesOnlyWhereAFilterHasTwoNumbersOfThem) {
  EXPECT_THAT(particle_curves(study_of({cell_of("fastslam2_m20", "fastslam2", 20, 2.0),
                                        cell_of("ufastslam_m3", "ufastslam", 3, 4.0)})),
              IsEmpty());
  const auto curves = particle_curves(
      study_of({cell_of("fs_m3_raw", "fs", 3, 2.0), cell_of("fs_m3_gps", "fs", 3, 2.0),
                cell_of("fs_m30_raw", "fs", 30, 1.0)}));
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_EQ(curves[0].legend, "fs_raw");
  EXPECT_EQ(curves[0].points.size(), 2u);
  EXPECT_EQ(curves[1].legend, "fs_gps");
}

TEST(ReferenceFigures, GoByPowersOfTenBeyondTwoDecades) {
  const auto axis_of = [](double best, double worst) {
    return reference_error_figure(
               study_of({cell_of("a", "a", 0, best), cell_of("b", "b", 0, worst)}))
        .chart.panels.at(0)
        .axis;
  };
  EXPECT_FALSE(axis_of(1.0, 40.0).logarithmic);
  EXPECT_TRUE(axis_of(1.0, 60.0).logarithmic);
  EXPECT_EQ(axis_of(1e-9, 60.0).low, 0.01);
}

TEST(ReferenceFigures, SpreadManyCellsOverAPanelForEachNumberOfParticles) {
  std::vector<CellAnalysis> cells = {cell_of("ekf_slam", "ekf_slam", 0, 1.0)};
  for (const std::string filter : {"a", "b", "c", "d"}) {
    cells.push_back(cell_of(filter + "_m3", filter, 3, 2.0));
    if (filter != "b") cells.push_back(cell_of(filter + "_m20", filter, 20, 3.0));
  }
  EXPECT_EQ(reference_error_figure(study_of(cells)).data.size(), 1u);  // eight are told apart
  cells.push_back(cell_of("e_m20", "e", 20, 5.0));
  const Figure figure = reference_error_figure(study_of(cells));
  ASSERT_EQ(figure.data.size(), 2u);
  EXPECT_EQ(figure.data[0].name, "reference_error_m3.csv");
  EXPECT_THAT(figure.data[1].headings,
              ElementsAre("time [s]", "ekf_slam", "a", "b", "c", "d", "e"));
  EXPECT_THAT(figure.data[1].rows[0], ElementsAre(0.5, 1.0, 3.0, testing::IsNan(), 3.0, 3.0, 5.0));
  EXPECT_THAT(figure.data[0].rows[0], ElementsAre(0.5, 1.0, 2.0, 2.0, 2.0, 2.0, testing::IsNan()));
  EXPECT_EQ(figure.chart.panels[1].label, "distance to gps [m], M = 20");
}

TEST(ReferenceFigures, AreNotDrawnWithoutReferences) {
  StudyAnalysis study = study_of({cell_of("a", "a", 0, 1.0)});
  study.references.clear();
  study.cells[0].findings.put(ReferenceAnalyses{});
  study.cells[0].scan_series.clear();
  EXPECT_THAT(reference_figures(study), IsEmpty());
}

}  // namespace
}  // namespace montecarta::analysis
