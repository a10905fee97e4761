// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/calibration.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

std::vector<PitHistogram> judged(const SyntheticStudy& study, std::size_t runs,
                                 const std::vector<RunRows>& extra = {}) {
  CalibrationSums sums;
  for (std::size_t run = 0; run < runs; ++run) {
    RunRows rows = study.run(run);
    if (run < extra.size()) {
      rows.cloud = extra[run].cloud;
      rows.final_map = extra[run].final_map;
    }
    sums.add(pits_of(rows, 0, run, {}));
  }
  return sums.result(study.times(), 0.95);
}

bool all_are(const std::vector<PitHistogram>& found, Calibration verdict, std::string quantity) {
  return std::ranges::all_of(found, [&](const PitHistogram& one) {
    return one.quantity != quantity || one.test.verdict == verdict;
  });
}

TEST(CellCalibration, NamesWhatIsWrongWithAFilter) {
  const auto sure = judged({.scans = 40, .inflation = 1.8}, 300);
  ASSERT_EQ(sure.size(), 12u) << "x, y, heading at four moments";
  for (const char* quantity : {"x", "y", "heading"}) {
    EXPECT_TRUE(all_are(sure, Calibration::too_narrow, quantity)) << quantity;
    EXPECT_TRUE(
        all_are(judged({.scans = 40, .inflation = 0.5}, 300), Calibration::too_wide, quantity));
  }
  const auto biased = judged({.scans = 40, .bias = {0.2, 0.0, 0.0}}, 300);
  EXPECT_TRUE(all_are(biased, Calibration::shifted, "x"));
}

// A cell has 12 histograms; 5 % of cells at most have a fault in any: 3 standard errors.
TEST(CellCalibration, FindsFaultWithAPerfectFilterInFivePercentOfStudies) {
  constexpr std::uint64_t kCells = 400;
  double rejected = 0.0;
  for (std::uint64_t seed = 0; seed < kCells; ++seed) {
    const auto found = judged({.scans = 4, .seed = 100 + seed}, 60);
    rejected += std::ranges::any_of(
        found, [](const PitHistogram& one) { return one.test.verdict != Calibration::calibrated; });
  }
  EXPECT_LT(rejected, 0.05 * kCells + 3.0 * std::sqrt(0.05 * 0.95 * kCells));
  EXPECT_GT(rejected, 0.0) << "a test that never fails is none";
}

/// A cloud of M particles around the truth of each moment, the truth one more draw of the same law.
CloudRows cloud_about(const RunRows& rows, std::size_t M, double spread, RngStream& draw) {
  CloudRows cloud;
  for (const std::size_t scan : calibration_scans(rows.truth.size() / 3)) {
    const double centre = draw.normal();
    for (std::size_t i = 0; i < M; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        cloud.pose.push_back(rows.truth[3 * scan + c] + 0.1 * (spread * draw.normal() - centre));
      }
      cloud.log_weight.push_back(-std::log(static_cast<double>(M)));
    }
  }
  return cloud;
}

/// Moments and particles of M draws from the law that the truth of each scan is drawn from too.
RunRows few_draws(std::size_t M, double weight_sigma, RngStream& draw) {
  RunRows rows;
  for (std::size_t m = 0; m < kQuarters; ++m) {
    std::vector<double> weights(M);
    double all = 0.0, squares = 0.0;
    for (double& weight : weights) all += weight = std::exp(weight_sigma * draw.normal());
    for (double& weight : weights) {
      weight /= all;
      squares += weight * weight;
      rows.cloud.log_weight.push_back(std::log(weight));
    }
    rows.ess.push_back(1.0 / squares);
    Eigen::Matrix3Xd poses(3, M);
    for (double& element : poses.reshaped()) element = 0.01 * draw.normal();
    const Eigen::Map<const Eigen::VectorXd> w(weights.data(), static_cast<Eigen::Index>(M));
    const Eigen::Vector3d mean = poses * w;
    const Eigen::Matrix3Xd rest = poses.colwise() - mean;
    const Eigen::Matrix3d P = rest * w.asDiagonal() * rest.transpose();
    rows.cloud.pose.insert(rows.cloud.pose.end(), poses.reshaped().begin(), poses.reshaped().end());
    rows.spread.mean.insert(rows.spread.mean.end(), mean.begin(), mean.end());
    rows.spread.covariance.insert(rows.spread.covariance.end(), P.data(), P.data() + 9);
    for (int c = 0; c < 3; ++c) rows.truth.push_back(0.01 * draw.normal());
  }
  return rows;
}

/// Share of histograms that find fault with a perfect sampler of so many draws.
double faulted(std::size_t M, double weight_sigma) {
  RngStream draw({.seed = 12, .index = static_cast<std::uint32_t>(M)});
  double faults = 0.0, tests = 0.0;
  for (int study = 0; study < 60; ++study) {
    CalibrationSums sums;
    for (std::uint64_t run = 0; run < 200; ++run) {
      sums.add(pits_of(few_draws(M, weight_sigma, draw), M, run, {}));
    }
    for (const PitHistogram& one : sums.result(std::vector<double>{1, 2, 3, 4}, 0.95)) {
      tests += 1.0;
      faults += one.test.verdict == Calibration::calibrated ? 0.0 : 1.0;
    }
  }
  return faults / tests;
}

// 24 histograms in each of 60 studies: five standard errors of 5 % are 2.9 %. By the Gaussian of
// its moments a perfect sampler of ten draws would be at fault in a third of them.
TEST(CellCalibration, DoesNotHoldFewDrawsAgainstAPerfectSampler) {
  EXPECT_LT(faulted(10, 0.0), 0.05 + 0.029);
  EXPECT_LT(faulted(30, 0.0), 0.05 + 0.029);
  EXPECT_LT(faulted(10, 0.7), 0.05 + 0.029);
}

TEST(CellCalibration, RanksTheTruthAmongTheParticles) {
  const SyntheticStudy study{.scans = 8};
  RngStream draw({.seed = 4});
  for (const double spread : {1.0, 0.3}) {
    CalibrationSums sums;
    for (std::uint64_t run = 0; run < 300; ++run) {
      RunRows rows = study.run(run);
      rows.cloud = cloud_about(rows, 20, spread, draw);
      sums.add(pits_of(rows, 0, run, {}));
    }
    const auto found = sums.result(study.times(), 0.999);
    ASSERT_EQ(found.size(), 24u);
    for (std::size_t i = 12; i < 24; ++i) {
      EXPECT_EQ(found[i].by, "particles");
      EXPECT_EQ(found[i].test.verdict,
                spread == 1.0 ? Calibration::calibrated : Calibration::too_narrow);
    }
  }
}

TEST(CellCalibration, TakesOneLandmarkOfEveryRun) {
  const std::vector<Eigen::Vector2d> world = {{0, 0}, {9, 9}, {5, 5}};
  const SyntheticStudy study{.scans = 8};
  RngStream draw({.seed = 6});
  CalibrationSums sums;
  for (std::uint64_t run = 0; run < 200; ++run) {
    RunRows rows = study.run(run);
    FinalMap map{{1, 0, 1}, world, std::vector<Eigen::Matrix2d>(3, Eigen::Matrix2d::Identity())};
    for (auto& mean : map.mean) mean += Eigen::Vector2d(draw.normal(), 3.0 * draw.normal());
    rows.final_map = map;
    sums.add(pits_of(rows, 0, run, world));
  }
  const auto found = sums.result(study.times(), 0.95);
  ASSERT_EQ(found.size(), 14u);
  EXPECT_EQ(found[12].quantity, "landmark x");
  EXPECT_EQ(found[12].test.verdict, Calibration::calibrated);
  EXPECT_EQ(found[13].test.verdict, Calibration::too_narrow);
}

TEST(CellCalibration, CountsWhatHasNoValue) {
  const SyntheticStudy study{.scans = 8};
  CalibrationSums sums;
  for (std::uint64_t run = 0; run < 50; ++run) {
    RunRows rows = study.run(run);
    if (run < 3) rows.spread.covariance.assign(rows.spread.covariance.size(), 0.0);
    sums.add(pits_of(rows, 0, run, {}));
  }
  const auto found = sums.result(study.times(), 0.95);
  EXPECT_EQ(found[0].undefined, 3u);
  EXPECT_TRUE(CalibrationSums().result(study.times(), 0.95).empty());
}

TEST(CellCalibration, IsTestedAtTheEndOfEachQuarter) {
  EXPECT_THAT(calibration_scans(100), ElementsAre(24, 49, 74, 99));
  EXPECT_THAT(calibration_scans(1), ElementsAre(0, 0, 0, 0));
}

/// No run has a value: no landmark was ever seen, or no covariance is one.
TEST(CalibrationFigures, DrawEmptyBinsWhereThereIsNoValue) {
  StudyAnalysis study;
  study.times = {1.0};
  study.cells.resize(1);
  study.cells[0].findings.put(
      Calibrations{{"landmark x", "Gaussian", 1.0, 3, judge_uniformity({}, band_for(0, 0.95))}});
  const Figure figure = reported_figure(study, "calibration");
  ASSERT_EQ(figure.data.size(), 1u);
  for (const auto& row : figure.data[0].rows) EXPECT_EQ(row[2], 0.0);
  EXPECT_GT(figure.chart.panels[0].axis.high, 0.0);
}

/// A cell of which the Gaussian was asked at the end of the run, and no particles are stored.
StudyAnalysis without_particles() {
  StudyAnalysis study;
  study.times = {0.2, 0.4};
  study.runs_here = 100;
  CellAnalysis cell;
  cell.label = "ekf_slam";
  PitHistogram histogram{"x", "Gaussian", 0.4, 0, {}};
  histogram.test.counts.assign(10, 10);
  cell.findings.put(Calibrations{histogram});
  study.cells = {cell};
  return study;
}

TEST(CalibrationFigures, DrawNothingOfParticlesThatAreNotStored) {
  EXPECT_FALSE(reported_figure(without_particles(), "calibration").data.empty());
  EXPECT_TRUE(reported_figure(without_particles(), "ranks").data.empty());
}

}  // namespace
}  // namespace montecarta::analysis
