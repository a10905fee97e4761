// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/error_anatomy.hpp"

#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/reported.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kAnatomyScans = 50;

/// Errors with these deviations and bias of a filter that believes deviations of 1.
ErrorAnatomy anatomy_of(const Eigen::Vector3d& deviations, const Eigen::Vector3d& bias,
                        std::size_t runs = 200) {
  ErrorMoments moments(kAnatomyScans);
  const std::vector<Eigen::Matrix3d> covariances(kAnatomyScans, Eigen::Matrix3d::Identity());
  for (std::size_t run = 0; run < runs; ++run) {
    RngStream draw({19, run, 0, 0, Draw::test});
    std::vector<Eigen::Vector3d> errors(kAnatomyScans);
    for (Eigen::Vector3d& error : errors) {
      const Eigen::Vector3d noise(draw.normal(), draw.normal(), draw.normal());
      error = bias + deviations.cwiseProduct(noise);
    }
    moments.add(errors, covariances);
  }
  return moments.result();
}

TEST(ErrorAnatomy, FindsNothingWrongWithAConsistentFilter) {
  const ErrorAnatomy found = anatomy_of({1, 1, 1}, {0, 0, 0});
  EXPECT_LT(found.mean_bias_share, 0.01);
  EXPECT_NEAR(found.happened[0][10], 1.0, 5.0 / std::sqrt(400.0));
  EXPECT_DOUBLE_EQ(found.believed[2][10], 1.0);
}

TEST(ErrorAnatomy, FindsScatterInOneComponent) {
  const ErrorAnatomy found = anatomy_of({1, 1, 3}, {0, 0, 0});
  EXPECT_NEAR(found.happened[2][10], 3.0, 5.0 * 3.0 / std::sqrt(400.0));
  EXPECT_NEAR(found.happened[1][10], 1.0, 5.0 / std::sqrt(400.0));
  EXPECT_LT(found.mean_bias_share, 0.02);
}

// NEES 3 + 4: four sevenths of it are bias.
TEST(ErrorAnatomy, TellsBiasFromScatter) {
  const ErrorAnatomy found = anatomy_of({1, 1, 1}, {0, 2, 0});
  EXPECT_NEAR(found.mean_bias_share, 4.0 / 7.0, 0.02);
  EXPECT_NEAR(found.bias[1][0], 2.0, 5.0 / std::sqrt(200.0));
}

/// One scan, with an error for each run.
ErrorAnatomy anatomy_of_scan(const std::vector<Eigen::Vector3d>& errors,
                             const Eigen::Vector3d& variances) {
  ErrorMoments moments(1);
  for (const Eigen::Vector3d& error : errors) {
    moments.add(std::vector{error},
                std::vector{Eigen::Matrix3d(Eigen::Matrix3d(variances.asDiagonal()))});
  }
  return moments.result();
}

// Errors of 3, 1, 3, 1 have the NEES 5, of which the square of the mean is 4. By chance the mean of
// four errors with a scatter of 1 has 1 / 3.
TEST(ErrorAnatomy, FreesTheBiasOfWhatAMeanHasByChance) {
  const std::vector<Eigen::Vector3d> errors = {{3, 0, 0}, {1, 0, 0}, {3, 0, 0}, {1, 0, 0}};
  EXPECT_NEAR(anatomy_of_scan(errors, {1, 1, 1}).bias_share[0], (4.0 - 1.0 / 3.0) / 5.0, 1e-12);
}

TEST(ErrorAnatomy, NeedsFourRunsWithNumbers) {
  const std::vector<Eigen::Vector3d> three = {{3, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_TRUE(std::isnan(anatomy_of_scan(three, {1, 1, 1}).bias_share[0]));
  const std::vector<Eigen::Vector3d> five = {
      {3, 0, 0}, {1, 0, 0}, {std::nan(""), 0, 0}, {3, 0, 0}, {1, 0, 0}};
  EXPECT_NEAR(anatomy_of_scan(five, {1, 1, 1}).bias_share[0], (4.0 - 1.0 / 3.0) / 5.0, 1e-12);
}

TEST(ErrorAnatomy, LeavesOutWhatIsNotFiniteAndSaysNothingOfNothing) {
  ErrorMoments moments(1);
  for (int run = 0; run < 3; ++run) {
    moments.add(std::vector{Eigen::Vector3d(1.0, std::nan(""), 0.0)},
                std::vector{Eigen::Matrix3d(Eigen::Matrix3d::Identity())});
  }
  EXPECT_TRUE(std::isnan(moments.result().bias_share[0]));
  EXPECT_TRUE(std::isnan(moments.result().mean_bias_share));
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
