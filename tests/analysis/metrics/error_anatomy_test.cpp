// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/error_anatomy.hpp"

#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
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
  EXPECT_LT(found.mean_worst_ratio, expected_worst_ratio(200, 0.95));
  EXPECT_NEAR(found.happened[0][10], 1.0, 5.0 / std::sqrt(400.0));
  EXPECT_DOUBLE_EQ(found.believed[2][10], 1.0);
}

TEST(ErrorAnatomy, NamesTheDirectionThatIsWrong) {
  const ErrorAnatomy found = anatomy_of({1, 1, 3}, {0, 0, 0});
  EXPECT_NEAR(found.mean_worst_ratio, 9.0, 0.5);
  EXPECT_GT(found.worst_direction[2], 0.97);
  EXPECT_LT(found.mean_bias_share, 0.02);
}

// NEES 3 + 4: four sevenths of it are bias.
TEST(ErrorAnatomy, TellsBiasFromScatter) {
  const ErrorAnatomy found = anatomy_of({1, 1, 1}, {0, 2, 0});
  EXPECT_NEAR(found.mean_bias_share, 4.0 / 7.0, 0.02);
  EXPECT_NEAR(found.mean_worst_ratio, 5.0, 0.5);
  EXPECT_GT(found.worst_direction[1], 0.95);
  EXPECT_NEAR(found.bias[1][0], 2.0, 5.0 / std::sqrt(200.0));
}

/// Of one scan; an error a run.
ErrorAnatomy anatomy_of_scan(const std::vector<Eigen::Vector3d>& errors,
                             const Eigen::Vector3d& variances) {
  ErrorMoments moments(1);
  for (const Eigen::Vector3d& error : errors) {
    moments.add(std::vector{error},
                std::vector{Eigen::Matrix3d(Eigen::Matrix3d(variances.asDiagonal()))});
  }
  return moments.result();
}

// Errors of 3, 1, 3, 1: NEES 5, of which 4 are the mean's square; a mean of four errors whose
// scatter is 1 has 1 / 3 by chance.
TEST(ErrorAnatomy, FreesTheBiasOfWhatAMeanHasByChance) {
  const std::vector<Eigen::Vector3d> errors = {{3, 0, 0}, {1, 0, 0}, {3, 0, 0}, {1, 0, 0}};
  EXPECT_NEAR(anatomy_of_scan(errors, {1, 1, 1}).bias_share[0], (4.0 - 1.0 / 3.0) / 5.0, 1e-12);
}

// Errors along (2, 1, 0) of a filter that believes deviations of (2, 1, 1): each axis has half.
TEST(ErrorAnatomy, MeasuresTheWorstDirectionInDeviations) {
  const std::vector<Eigen::Vector3d> errors = {{2, 1, 0}, {-2, -1, 0}, {2, 1, 0}, {-2, -1, 0}};
  const ErrorAnatomy found = anatomy_of_scan(errors, {4, 1, 1});
  EXPECT_NEAR(found.worst_ratio[0], 2.0, 1e-9);
  EXPECT_NEAR(found.worst_direction[0], 0.5, 1e-9);
  EXPECT_NEAR(found.worst_direction[1], 0.5, 1e-9);
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
  EXPECT_TRUE(std::isnan(moments.result().worst_ratio[0]));
  EXPECT_TRUE(std::isnan(moments.result().mean_worst_ratio));
}

// Largest eigenvalue of W(I, 30) / 30, 95 %: 1.841 by numpy with 100,000 draws.
TEST(ExpectedWorstRatio, IsThatOfAWishartMatrix) {
  EXPECT_NEAR(expected_worst_ratio(30, 0.95), 1.841, 0.04);
  EXPECT_LT(expected_worst_ratio(1000, 0.95), 1.15);
  EXPECT_TRUE(std::isinf(expected_worst_ratio(2, 0.95)));
}

}  // namespace
}  // namespace montecarta::analysis
