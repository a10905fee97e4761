// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/error_moments.hpp"
#include "engine/numbers/angle.hpp"
#include "tests/analysis/reported.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

// Errors of 3, 1, 3, 1 have the mean 2 and the mean square 5.
TEST(ErrorMoments, GiveMeanAndRootMeanSquareOfEveryScanBesideTheReportedDeviation) {
  ErrorMoments moments(2);
  const Eigen::Matrix3d covariance = Eigen::Vector3d(4, 9, 16).asDiagonal();
  const Eigen::Vector3d none(std::nan(""), 0, 0);
  for (const double error : {3.0, 1.0, 3.0, 1.0}) {
    moments.add(std::vector{Eigen::Vector3d(0, error, 0), none},
                std::vector{covariance, covariance});
  }
  moments.add(std::vector{none, none}, std::vector{covariance, covariance});
  const ErrorsOverTime found = moments.result();
  EXPECT_DOUBLE_EQ(found.mean[1][0], 2.0);
  EXPECT_DOUBLE_EQ(found.rms[1][0], std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(found.believed[2][0], 4.0);
  EXPECT_TRUE(std::isnan(found.rms[1][1])) << "no error of the second scan is finite";
}

// A covariance of (4, 9, 16): three standard deviations are 6, 9 and 12.
ErrorTrace trace_of_a_scan() {
  const Eigen::Matrix3d covariance = Eigen::Vector3d(4, 9, 16).asDiagonal();
  return error_trace(7, std::vector{Eigen::Vector3d(1, -2, 3)}, std::vector{covariance});
}

TEST(ErrorTrace, HasTheDeviationOfEachComponent) {
  const ErrorTrace trace = trace_of_a_scan();
  EXPECT_EQ(trace.run, 7u);
  EXPECT_EQ(trace.error[1], std::vector{-2.0});
  EXPECT_EQ(trace.deviation[2], std::vector{4.0});
}

StudyAnalysis study_with_traces(std::size_t cells) {
  StudyAnalysis study;
  study.times = {0.5};
  study.cells.resize(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    study.cells[i].label = "cell" + std::to_string(i);
    study.cells[i].findings.put(trace_of_a_scan());
  }
  return study;
}

TEST(ErrorEnvelopes, AreThreeDeviationsAroundZero) {
  const Figure figure = reported_figure(study_with_traces(2), "error_envelopes");
  ASSERT_EQ(figure.chart.panels.size(), 6u);
  const ChartPanel& left = figure.chart.panels[4];
  EXPECT_EQ(left.cell, "cell1");
  EXPECT_EQ(left.label, "left [m], cell1");
  EXPECT_EQ(left.curves.at(0).style, 1u);
  EXPECT_EQ(left.curves.at(0).values, std::vector{-2.0});
  EXPECT_EQ(left.curves.at(0).envelope, std::vector{9.0});
  EXPECT_DOUBLE_EQ(left.axis.low, -left.axis.high);
  EXPECT_GT(left.axis.high, 9.0);
  EXPECT_NEAR(figure.chart.panels[2].curves.at(0).envelope.at(0), 12.0 * 180.0 / kPi, 1e-9);
}

TEST(ErrorEnvelopes, AreOfTheFirstSixCellsThatHaveACovariance) {
  StudyAnalysis study = study_with_traces(9);
  study.cells[1] = CellAnalysis();
  const Figure figure = reported_figure(study, "error_envelopes");
  ASSERT_EQ(figure.chart.panels.size(), 18u);
  EXPECT_EQ(figure.chart.panels.back().cell, "cell6");
  EXPECT_TRUE(reported_figure(StudyAnalysis(), "error_envelopes").data.empty());
}

}  // namespace
}  // namespace montecarta::analysis
