// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_filters.hpp"
#include "tests/filters/default_options.hpp"
#include "tests/filters/fastslam/delayed_variants.hpp"
#include "tests/filters/told_bits.hpp"

namespace montecarta::filters {
namespace {

std::vector<ToldBits> told(const Variant& variant, const SmallWorldSettings& settings) {
  const auto filter = make_production(variant, settings);
  std::vector<ToldBits> bits;
  drive_through(*filter, small_world(settings), Pose(), [&](std::size_t) {
    bits.emplace_back(*filter, variant.particles, settings.landmarks);
  });
  return bits;
}

TEST(Delayed, DrawingAtEveryScanIsFastSlam2BitForBit) {
  const SmallWorldSettings settings{.scans = 200, .max_range = 20.0};
  for (const auto association : {Association::known, Association::nearest}) {
    const auto now = told({.filter = "fastslam2", .association = association}, settings);
    const auto then = told(delayed("1", 13, association), settings);
    ASSERT_EQ(now.size(), then.size());
    for (std::size_t scan = 0; scan < now.size(); ++scan) {
      ASSERT_TRUE(now[scan] == then[scan]) << "scan " << scan;
    }
  }
}

TEST(Delayed, OneParticleThatNeverDrawsIsEkfSlam) {
  const SmallWorldSettings settings{.scans = 250, .max_range = 20.0};
  const SmallWorld world = small_world(settings);
  for (const auto association : {Association::known, Association::nearest}) {
    const Variant variant = delayed("0", 1, association);
    const auto kalman = make_ekf_slam({.belief = {},
                                       .association = {.kind = association},
                                       .options = default_options(ekf_slam_kind()),
                                       .landmarks = settings.landmarks});
    const auto filter = make_production(variant, settings);
    std::vector<PoseMoments> poses;
    std::vector<ScanReport> reports;
    drive_through(*kalman, world, Pose(), [&](std::size_t) {
      poses.push_back(kalman->estimate().spread);
      reports.push_back(kalman->report());
    });
    drive_through(*filter, world, Pose(), [&](std::size_t scan) {
      expect_near(filter->estimate().spread, poses[scan], 1e-9);
      if (reports[scan].nis_dof > 0) {  // a scan all ignored counts log p0 in EKF-SLAM alone
        EXPECT_NEAR(filter->report().log_likelihood, reports[scan].log_likelihood, 1e-7);
      }
      EXPECT_NEAR(filter->report().nis, reports[scan].nis, 1e-7);
      EXPECT_EQ(filter->report().map_size, reports[scan].map_size);
    });
    std::vector<std::optional<LandmarkEstimate>> one(settings.landmarks), other(one);
    kalman->map(one), filter->map(other);
    for (std::size_t k = 0; k < one.size(); ++k) {
      ASSERT_EQ(one[k].has_value(), other[k].has_value());
      if (!one[k]) continue;
      EXPECT_LT((one[k]->mean - other[k]->mean).norm(), 1e-9);
      EXPECT_LT((one[k]->covariance - other[k]->covariance).norm(), 1e-9);
    }
  }
}

TEST(Delayed, EqualsTheEigenReference) {
  const SmallWorldSettings settings{.scans = 80};
  for (const char* every : {"2", "7", "0"}) {
    for (const std::size_t particles : {1, 13}) {
      const Variant variant = delayed(every, particles);
      const auto lanes = make_production(variant, settings);
      const auto plain = reference::make_delayed_fast_slam(reference_settings(variant, settings),
                                                           std::stoul(every));
      expect_same_run(*lanes, *plain, small_world(settings), 1e-8);
    }
  }
}

TEST(Delayed, EstimatesBetweenScansAsTheReferenceDoes) {
  const SmallWorldSettings settings{.scans = 20};
  const Variant variant = delayed("3");
  const auto lanes = make_production(variant, settings);
  const auto plain = reference::make_delayed_fast_slam(reference_settings(variant, settings), 3);
  expect_same_steps(*lanes, *plain, small_world(settings), 1e-9);
}

TEST(Delayed, WalkingBackThroughAncestorsNeverJumpsFartherThanThreeScansOfNoise) {
  // As the law of every filter has it, but for draws that make up for three scans.
  const std::size_t n = 50;
  const SmallWorldSettings settings{.landmarks = 6,
                                    .scans = 200,
                                    .max_range = 80.0,
                                    .noise = {.sigma_range = 1.0, .sigma_bearing = 0.2}};
  const auto filter = make_production(delayed("3", n), settings);
  std::vector<double> poses(3 * n), before(3 * n, 0.0), log_weights(n);
  std::vector<std::uint32_t> ancestors(n);
  int resampled_undrawn = 0;
  double widest = 0.0;
  drive_through(*filter, small_world(settings), Pose(), [&](std::size_t scan) {
    filter->particles({poses, log_weights, ancestors});
    for (std::size_t i = 0; i < n; ++i) {
      const double* from = &before[3 * ancestors[i]];
      Pose pose{from[0], from[1], from[2]};
      for (int k = 0; k < 8; ++k) pose = move(pose, Control{3.0, 0.15}, 0.025, Vehicle());
      const auto noise = boxminus(Pose{poses[3 * i], poses[3 * i + 1], poses[3 * i + 2]}, pose);
      ASSERT_LT(noise.head<2>().norm(), 0.25) << "scan " << scan << ", particle " << i;
      ASSERT_LT(std::abs(noise(2)), 0.04) << "scan " << scan << ", particle " << i;
    }
    const PoseEstimate now = filter->estimate();
    widest = std::max(widest, std::sqrt(now.spread.covariance.diagonal().head<2>().sum()));
    // Without a draw there is no cloud, and the spread is the mixture's.
    const bool same = now.spread.covariance == now.mixture->covariance;
    EXPECT_EQ(same, scan % 3 != 2) << "scan " << scan;
    resampled_undrawn += filter->report().resampled && same;
    before = poses;
  });
  EXPECT_GT(resampled_undrawn, 0) << "the law was not put to the test";
  EXPECT_GT(widest, 0.5) << "the law was not put to the test";
}

}  // namespace
}  // namespace montecarta::filters
