// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "tests/filters/fastslam/filter_comparison.hpp"
#include "tests/filters/reference/moved_fast_slam.hpp"
#include "tests/filters/told_bits.hpp"

namespace montecarta {
namespace {

Variant moved(const char* lag, const char* weights = "closed", std::size_t particles = 13,
              const char* filter = "fastslam2") {
  return {filter, weights, Association::known, particles, {{"move_lag", lag}}};
}

/// Landmarks are born, left and met again, and most scans end with a resampling.
SmallWorldSettings world() {
  return {.landmarks = 40,
          .scans = 120,
          .max_range = 20.0,
          .noise = {.sigma_speed = 0.6, .sigma_steer = 0.1}};
}

TEST(Moved, EqualsTheEigenReferenceThatLivesItsPastAgain) {
  for (const char* lag : {"1", "2", "7", "30"}) {
    for (const char* weights : {"closed", "ratio"}) {
      const Variant variant = moved(lag, weights);
      const auto lanes = make_production(variant, world());
      reference::MovedFastSlam2 plain(reference_settings(variant, world()),
                                      reference_weight(variant), std::stoul(lag));
      expect_same_run(*lanes, plain, small_world(world()), 1e-8);
      EXPECT_GT(plain.taken, 20) << "lag " << lag << ": nothing was put to the test";
    }
  }
}

std::vector<ToldBits> told(const Variant& variant, const Parallel& parallel) {
  const auto filter = make_production(variant, world());
  std::vector<ToldBits> bits;
  drive_through(
      *filter, small_world(world()), Pose(),
      [&](std::size_t) { bits.emplace_back(*filter, variant.particles, world().landmarks); },
      parallel);
  return bits;
}

TEST(Moved, GivesTheSameBitsOnAnyNumberOfThreads) {
  for (const char* filter : {"fastslam2", "srcd"}) {
    const Variant variant = moved("5", "closed", 700, filter);
    const auto alone = told(variant, Parallel::serial());
    const auto together = told(variant, Parallel(Backend::tbb, 3));
    EXPECT_TRUE(alone == together) << filter;
    Variant still = variant;
    still.options.clear();
    EXPECT_FALSE(alone == told(still, Parallel::serial())) << filter << " does not move";
  }
}

/// Mean pose after the world's last scan, over many particles.
struct LastPose {
  PoseMoments spread;
  double ess;
};
LastPose last_pose(const Variant& variant, const SmallWorldSettings& settings) {
  const auto filter = make_production(variant, settings);
  drive_through(*filter, small_world(settings), Pose(), [](std::size_t) {});
  return {filter->estimate().spread, filter->report().ess};
}

TEST(Moved, LeavesTheParticlesDistributedAsTheWeightsSay) {
  // Against plain importance sampling, which neither resamples nor moves. Moves that reach back to
  // the start and follow every scan would soon undo the weights if they were taken unasked.
  const SmallWorldSettings settings{
      .landmarks = 40,
      .scans = 16,
      .max_range = 25.0,
      .noise = {.sigma_speed = 1.5, .sigma_steer = 0.3, .sigma_range = 0.5, .sigma_bearing = 0.1}};
  Variant weighed = moved("0", "closed", 20000), by_moves = moved("20", "closed", 20000);
  weighed.options["resample_below"] = "0";
  by_moves.options["resample_below"] = "1";
  const LastPose one = last_pose(weighed, settings), other = last_pose(by_moves, settings);
  EXPECT_LT(one.ess, 12000.0) << "the weights say nothing";
  EXPECT_GT(one.ess, 300.0) << "too few to compare with";
  const Eigen::Vector3d apart = boxminus(one.spread.mean, other.spread.mean);
  for (int k = 0; k < 3; ++k) {
    const double error = std::sqrt(one.spread.covariance(k, k) * (1.0 / one.ess + 1.0 / 4000.0));
    EXPECT_LT(std::abs(apart(k)), 5.0 * error) << "component " << k << ", ess " << one.ess;
  }
}

TEST(Moved, FaultsOfReplaysAreCountedWithTheNextScan) {
  // All stand on landmark 1 when they see it again, so it is left out: then, and whenever the scan
  // is lived through once more.
  Variant variant = moved("1", "closed", 9);
  variant.options["resample_below"] = "1";
  const std::vector<Detection> there{{10.0, 0.3, 0}}, both{{10.0, 0.3, 0}, {1e-9, 0.0, 1}};
  for (const char* filter : {"fastslam2", "ufastslam", "srcd"}) {
    variant.filter = filter;
    const auto f = make_production(variant, world());
    std::uint32_t step = 0;
    const auto context = [&] { return StepContext(1, 0, step++, Parallel::serial()); };
    const auto faults_after = [&](double duration, const std::vector<Detection>& scan) {
      const StepContext now = context();
      f->predict(now, {3.0, 0.1}, duration);
      f->update(now, scan);
      return f->report().numerical_faults;
    };
    for (const bool is_cut_short : {true, false}) {
      f->start(Pose());
      EXPECT_EQ(faults_after(0.2, there), 0U) << filter;
      EXPECT_EQ(faults_after(0.2, there), 0U) << filter;
      EXPECT_EQ(faults_after(0.0, both), 0U) << filter;
      EXPECT_EQ(faults_after(0.0, both), 9U) << filter;
      ASSERT_TRUE(f->report().resampled) << filter;
      if (is_cut_short) f->predict(context(), {3.0, 0.1}, 0.2);
    }
    EXPECT_EQ(faults_after(0.2, there), 9U) << filter << ": of the replay";
    ASSERT_TRUE(f->report().resampled) << filter;
    EXPECT_EQ(faults_after(0.2, there), 0U) << filter << ": that scan is out of the window";
  }
}

TEST(Moved, SaysWhatItDoesNotGoTogetherWith) {
  Variant nearest = moved("3"), anchored = moved("3");
  nearest.association = Association::nearest;
  anchored.options["landmarks"] = "anchored";
  for (Variant variant : {nearest, anchored}) {
    for (const char* filter : {"fastslam2", "ufastslam", "srcd"}) {
      variant.filter = filter;
      variant.options["move_lag"] = "3";
      EXPECT_THROW(kind_of(variant).check(setup_of(variant, world())), StudyError) << filter;
      EXPECT_THROW(make_production(variant, world()), StudyError) << filter;
      variant.options["move_lag"] = "0";
      EXPECT_NO_THROW(kind_of(variant).check(setup_of(variant, world()))) << filter;
    }
  }
}

}  // namespace
}  // namespace montecarta
