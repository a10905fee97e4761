// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/calibration.hpp"

#include "analysis/run/pits.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/doubles/matchers.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

std::vector<JudgedPits> judged(const SyntheticStudy& study, std::size_t runs,
                               const std::vector<RunRows>& extra = {}) {
  CalibrationSums sums;
  for (std::size_t run = 0; run < runs; ++run) {
    RunRows rows = study.run(run);
    if (run < extra.size()) {
      rows.particle_pose = extra[run].particle_pose;
      rows.log_weight = extra[run].log_weight;
      rows.final_map = extra[run].final_map;
    }
    sums.add(pits_of(rows, 0, run, {}));
  }
  return sums.result(study.times(), 0.95);
}

bool all_are(const std::vector<JudgedPits>& found, Calibration verdict, std::string quantity) {
  return std::ranges::all_of(found, [&](const JudgedPits& one) {
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

// A cell has 12 tests, of up to 30; 5 % of cells at most have a fault in any: 3 standard errors.
TEST(CellCalibration, SlowFindsFaultWithAPerfectFilterInFivePercentOfStudies) {
  constexpr std::uint64_t kCells = 400;
  double rejected = 0.0;
  for (std::uint64_t seed = 0; seed < kCells; ++seed) {
    const auto found = judged({.scans = 4, .seed = 100 + seed}, 60);
    rejected += std::ranges::any_of(
        found, [](const JudgedPits& one) { return one.test.verdict != Calibration::calibrated; });
  }
  EXPECT_LT(rejected, 0.05 * kCells + 3.0 * std::sqrt(0.05 * 0.95 * kCells));
  EXPECT_GT(rejected, 0.0) << "a test that never fails is none";
}

/// Adds M particles around the truth of each moment, the truth one more draw of the same law.
void add_cloud(std::size_t M, double spread, RngStream& draw, RunRows& rows) {
  rows.particle_pose.resize(rows.truth.size() * M);
  rows.log_weight.resize(rows.truth.size() / 3 * M, -std::log(static_cast<double>(M)));
  for (const std::size_t scan : calibration_scans(rows.truth.size() / 3)) {
    const Eigen::Vector3d centre(draw.normal(), draw.normal(), draw.normal());
    for (std::size_t i = scan * M; i < (scan + 1) * M; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        rows.particle_pose[3 * i + c] =
            rows.truth[3 * scan + c] +
            0.1 * (spread * draw.normal() - centre[static_cast<Eigen::Index>(c)]);
      }
    }
  }
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
      rows.log_weight.push_back(std::log(weight));
    }
    rows.ess.push_back(1.0 / squares);
    Eigen::Matrix3Xd poses(3, M);
    for (double& element : poses.reshaped()) element = 0.01 * draw.normal();
    const Eigen::Map<const Eigen::VectorXd> w(weights.data(), static_cast<Eigen::Index>(M));
    const Eigen::Vector3d mean = poses * w;
    const Eigen::Matrix3Xd rest = poses.colwise() - mean;
    const Eigen::Matrix3d P = rest * w.asDiagonal() * rest.transpose();
    rows.particle_pose.insert(rows.particle_pose.end(), poses.reshaped().begin(),
                              poses.reshaped().end());
    rows.spread.mean.insert(rows.spread.mean.end(), mean.begin(), mean.end());
    rows.spread.covariance.insert(rows.spread.covariance.end(), P.data(), P.data() + 9);
    for (int c = 0; c < 3; ++c) rows.truth.push_back(0.01 * draw.normal());
  }
  return rows;
}

/// Share of tests that find fault with a perfect sampler of so many draws.
double faulted(std::size_t M, double weight_sigma) {
  RngStream draw({.seed = 12, .index = static_cast<std::uint32_t>(M)});
  double faults = 0.0, tests = 0.0;
  for (int study = 0; study < 60; ++study) {
    CalibrationSums sums;
    for (std::uint64_t run = 0; run < 200; ++run) {
      sums.add(pits_of(few_draws(M, weight_sigma, draw), M, run, {}));
    }
    for (const JudgedPits& one : sums.result(std::vector<double>{1, 2, 3, 4}, 0.95)) {
      tests += 1.0;
      faults += one.test.verdict == Calibration::calibrated ? 0.0 : 1.0;
    }
  }
  return faults / tests;
}

// There are 24 tests in each of 60 studies: five standard errors of 5 % are 2.9 %. The Gaussian of
// the moments would find fault with a perfect sampler of ten draws in a third of them.
TEST(CellCalibration, SlowDoesNotHoldFewDrawsAgainstAPerfectSampler) {
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
      add_cloud(20, spread, draw, rows);
      sums.add(pits_of(rows, 0, run, {}));
    }
    const auto found = sums.result(study.times(), 0.999);
    ASSERT_EQ(found.size(), 28u);
    for (std::size_t i = 12; i < 28; ++i) {
      EXPECT_EQ(found[i].by, "particles");
      EXPECT_EQ(found[i].test.verdict,
                spread == 1.0 ? Calibration::calibrated : Calibration::too_narrow);
    }
  }
}

/// On a thin ring: far from the mean, whose covariance is wide.
Eigen::Vector3d on_ring(RngStream& draw, double width) {
  const double angle = kTwoPi * draw.uniform(), radius = 1.0 + width * draw.normal();
  return {radius * std::cos(angle), radius * std::sin(angle), 0.01 * draw.normal()};
}

// Sums of weights in place of draws of equal weight deviate from the uniform law by 0.02 here,
// which so many runs show. A truth off the ring is noticed.
TEST(CellCalibration, RanksTheTruthWhateverTheShapeAndTheWeights) {
  RngStream draw({.seed = 21});
  for (const double width_of_truth : {0.05, 0.3}) {
    CalibrationSums sums;
    for (std::uint64_t run = 0; run < 20000; ++run) {
      constexpr std::size_t kParticles = 60;
      RunRows rows;
      for (std::size_t i = 0; i < kParticles; ++i) {
        rows.log_weight.push_back(2.0 * draw.normal());
        const Eigen::Vector3d pose = on_ring(draw, 0.05);
        rows.particle_pose.insert(rows.particle_pose.end(), pose.begin(), pose.end());
      }
      const Eigen::Vector3d truth = on_ring(draw, width_of_truth);
      rows.truth.assign(truth.begin(), truth.end());
      sums.add(pits_of(rows, kParticles, run, {}));
    }
    const auto found = sums.result(std::vector<double>{1.0}, 0.95);
    ASSERT_EQ(found.size(), 16u);
    for (const JudgedPits& one : found) {
      if (width_of_truth > 0.05 && one.quantity != kNees) continue;
      EXPECT_EQ(one.by, "particles");
      EXPECT_EQ(one.test.verdict == Calibration::calibrated, width_of_truth == 0.05)
          << one.quantity;
    }
  }
}

TEST(CellCalibration, RanksNoDistanceByThreeParticlesOrFewer) {
  RngStream draw({.seed = 6});
  for (const std::size_t M : {2, 3, 6}) {
    RunRows rows;
    rows.truth.assign(3, 0.0);
    add_cloud(M, 1.0, draw, rows);
    EXPECT_TRUE(std::isnan(pits_of(rows, M, 0, {}).rank_nees.back())) << M;
    EXPECT_FALSE(std::isnan(pits_of(rows, M, 0, {}).rank.back()[0])) << M;
  }
}

TEST(CellCalibration, RanksNothingAmongParticlesThatTheScanDidNotDraw) {
  RngStream draw({.seed = 5});
  RunRows rows;
  rows.truth.assign(3, 0.0);
  add_cloud(20, 0.1, draw, rows);
  rows.spread.mean.assign(3, 0.0);
  rows.spread.covariance.assign(9, 1.0);
  rows.mixture = rows.spread;
  EXPECT_TRUE(std::isnan(pits_of(rows, 20, 0, {}).rank.back()[0]));
  EXPECT_TRUE(std::isnan(pits_of(rows, 20, 0, {}).rank_nees.back()));
  rows.mixture.covariance[0] = 2.0;
  EXPECT_FALSE(std::isnan(pits_of(rows, 20, 0, {}).rank.back()[0]));
  EXPECT_FALSE(std::isnan(pits_of(rows, 20, 0, {}).rank_nees.back()));
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

TEST(CellCalibration, IsTestedAtTheEndOfEachQuarterAndCountsWhatHasNoValue) {
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
  EXPECT_THAT(calibration_scans(100), ElementsAre(24, 49, 74, 99));
  EXPECT_THAT(calibration_scans(1), ElementsAre(0, 0, 0, 0));
}

/// Tests of a NEES of `dimension` components that is `inflation` times chi-square.
std::vector<JudgedPits> judged_nees(std::size_t dimension, double inflation, std::size_t runs) {
  RngStream draw({.seed = 21, .index = static_cast<std::uint32_t>(dimension)});
  CalibrationSums sums;
  for (std::size_t run = 0; run < runs; ++run) {
    std::vector<double> nees(8, 0.0);
    for (double& value : nees) {
      for (std::size_t c = 0; c < dimension; ++c) value += inflation * std::pow(draw.normal(), 2);
    }
    if (run < 3) nees.back() = kNaN;
    RunPits pits;
    pits.has_nees = true;
    pits.nees = nees_pits(nees, dimension);
    sums.add(pits);
  }
  return sums.result(scan_times(8), 0.95);
}

TEST(CellCalibration, ComparesTheNeesToItsChiSquareLaw) {
  for (const std::size_t dimension : {1u, 3u, 20u}) {
    const auto all_nees = [&](double inflation, Calibration verdict) {
      return all_are(judged_nees(dimension, inflation, 500), verdict, "NEES");
    };
    EXPECT_TRUE(all_nees(1.0, Calibration::calibrated)) << dimension;
    EXPECT_TRUE(all_nees(1.7, Calibration::too_narrow)) << dimension;
    EXPECT_TRUE(all_nees(0.5, Calibration::too_wide)) << dimension;
  }
  const auto found = judged_nees(3, 1.0, 60);
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0].time, 2.0);
  EXPECT_EQ(found[2].undefined, 0u);
  EXPECT_EQ(found[3].undefined, 3u) << "no NEES at the end of three runs";
}

/// A study of `runs` with the NEES of one cell, and no particles.
StudyAnalysis with_nees(std::size_t runs) {
  StudyAnalysis study;
  study.times = scan_times(8);
  study.cells.resize(1);
  study.cells[0].label = "ekf_slam";
  study.cells[0].findings.put(judged_nees(3, 1.7, runs));
  return study;
}

TEST(CalibrationFigures, DrawTheEcdfWithItsBandOfWhatIsJudged) {
  const StudyAnalysis study = with_nees(200);
  const Figure figure = reported_figure(study, "nees_quantiles");
  ASSERT_EQ(figure.data.size(), 4u) << "a panel for each quarter";
  const Frame& frame = figure.data[0].frame;
  ASSERT_EQ(frame.rows(), kEcdfSteps + 1);
  const Uniformity& test = study.cells[0].get<Calibrations>()[0].test;
  for (std::size_t j = 0; j < frame.rows(); ++j) {
    const double point = static_cast<double>(j) / kEcdfSteps;
    const auto from_point = [&](std::size_t count) {
      return static_cast<double>(count) / 200.0 - point;
    };
    EXPECT_THAT(row_of(frame, j),
                ElementsAre(point, from_point(test.counts[j]), from_point(test.band.upper(j)),
                            from_point(test.band.lower[j])));
  }
  EXPECT_TRUE(reported_figure(study, "ranks").data.empty()) << "no particles are stored";
  EXPECT_TRUE(reported_figure(with_nees(kLeastValues - 1), "nees_quantiles").data.empty());
}

TEST(CalibrationTable, HasColumnsOfTheQuantitiesThatAreStored) {
  const TextTable table = reported_table(with_nees(200), "calibration");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_THAT(table.rows[0], ElementsAre("ekf_slam", "Gaussian", "too narrow", "4 of 4"));
}

}  // namespace
}  // namespace montecarta::analysis
