// SPDX-License-Identifier: BSD-3-Clause
#include "tests/filters/fastslam/delayed_variants.hpp"
#include "tests/filters/reference/anchored_ekf_slam.hpp"
#include "tests/filters/reference/delayed_fast_slam.hpp"

namespace montecarta {
namespace {

TEST(DelayedAnchored, OneParticleThatNeverDrawsIsEkfSlamInAnchoredCoordinates) {
  const SmallWorldSettings settings = rough_small_world(250);
  const SmallWorld world = small_world(settings);
  const auto filter = make_production(anchored(delayed("0", 1)), settings);
  reference::AnchoredEkfSlam plain(settings.noise);
  plain.start(Pose());
  filter->start(Pose());
  std::uint32_t scan = 0;
  for (std::uint32_t step = 0; step < world.itinerary.steps(); ++step) {
    const StepContext context(world.seed, 0, step, Parallel::serial());
    plain.predict(world.drive.controls[step], world.itinerary.duration(step));
    filter->predict(context, world.drive.controls[step], world.itinerary.duration(step));
    if (world.itinerary.scan_step[scan] != step) continue;
    plain.update(world.drive.scan(scan));
    filter->update(context, world.drive.scan(scan++));
    expect_near(filter->estimate().spread, {plain.pose(), plain.covariance.topLeftCorner<3, 3>()},
                1e-9);
  }
  std::vector<std::optional<LandmarkEstimate>> map(settings.landmarks);
  filter->map(map);
  std::size_t known = 0;
  for (std::size_t k = 0; k < map.size(); ++k) {
    const Eigen::Index row = plain.row_of(static_cast<std::int32_t>(k));
    ASSERT_EQ(map[k].has_value(), row >= 0);
    if (!map[k]) continue;
    ++known;
    EXPECT_LT((map[k]->mean - plain.place(row)).norm(), 1e-9);
    EXPECT_LT((map[k]->covariance - plain.place_covariance(row)).norm(), 1e-9);
  }
  EXPECT_GT(known, 10U);
}

TEST(DelayedAnchored, EqualsTheEigenReference) {
  const SmallWorldSettings settings = rough_small_world(80);
  for (const char* every : {"2", "7", "0"}) {
    for (const std::size_t particles : {1, 13}) {
      const Variant variant = anchored(delayed(every, particles));
      const auto lanes = make_production(variant, settings);
      reference::DelayedFastSlam<reference::AnchoredEkfSlam> plain(
          reference_settings(variant, settings), std::stoul(every));
      expect_same_run(*lanes, plain, small_world(settings), 1e-8);
    }
  }
}

TEST(DelayedAnchored, IsNotTheFilterWithGaussiansInTheMap) {
  const SmallWorldSettings settings = rough_small_world();
  for (const char* filter : {"delayed", "delayed_srcd"}) {
    Variant in_map = delayed("6");
    in_map.filter = filter;
    const auto one = make_production(anchored(in_map), settings);
    const auto other = make_production(in_map, settings);
    drive_through(*one, small_world(settings), Pose(), [](std::size_t) {});
    drive_through(*other, small_world(settings), Pose(), [](std::size_t) {});
    const double apart =
        boxminus(one->estimate().spread.mean, other->estimate().spread.mean).norm();
    EXPECT_GT(apart, 1e-6) << filter;
    EXPECT_LT(apart, 5.0) << filter;
  }
}

TEST(DelayedAnchored, ByFineSensorsTheTwoKindsOfLandmarksAndOfTransformsAgree) {
  // Where nothing bends, coordinates and transforms make no difference.
  const SmallWorldSettings settings{
      .scans = 60,
      .noise = {
          .sigma_speed = 0.01, .sigma_steer = 1e-3, .sigma_range = 3e-3, .sigma_bearing = 1e-4}};
  for (const auto association : {Association::known, Association::nearest}) {
    const auto plain = make_production(delayed("0", 1, association), settings);
    drive_through(*plain, small_world(settings), Pose(), [](std::size_t) {});
    const PoseMoments expected = plain->estimate().spread;
    for (const char* name : {"delayed", "delayed_srcd"}) {
      Variant variant = anchored(delayed("0", 1, association));
      variant.filter = name;
      const auto filter = make_production(variant, settings);
      drive_through(*filter, small_world(settings), Pose(), [](std::size_t) {});
      const PoseMoments now = filter->estimate().spread;
      for (int k = 0; k < 3; ++k) {
        const double sigma = std::sqrt(expected.covariance(k, k));
        EXPECT_NEAR(boxminus(now.mean, expected.mean)(k), 0.0, 0.02 * sigma) << variant;
        EXPECT_NEAR(std::sqrt(now.covariance(k, k)), sigma, 0.01 * sigma) << variant;
      }
    }
  }
}

}  // namespace
}  // namespace montecarta
