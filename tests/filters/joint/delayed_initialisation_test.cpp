// SPDX-License-Identifier: BSD-3-Clause
// Landmarks that one detection does not fix, in a map of which most is far from the vehicle.
#include "filters/joint/joint_belief.hpp"
#include "filters/joint/joint_filter.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr std::size_t kLandmarks = 300;

SmallWorldSettings large_world(const Sensor& sensor) {
  Belief noise{.sigma_range = 0.02, .sigma_bearing = 0.003};
  noise.control.sigma = {0.02, 0.02, 0.0};
  noise.sensor = sensor;
  return {.landmarks = kLandmarks, .scans = 300, .noise = noise};
}

/// Each landmark is hidden for some time after its first detection, so that the places it was seen
/// from are far behind where it is initialised.
void hide_after_first_detection(SmallWorld& world) {
  constexpr std::size_t kHidden = 50;  // scans
  std::vector<std::optional<std::size_t>> first(kLandmarks);
  Drive shown = world.drive;
  shown.detections.clear();
  shown.scan_begin = {0};
  for (std::size_t scan = 0; scan + 1 < world.drive.scan_begin.size(); ++scan) {
    for (std::uint32_t i = world.drive.scan_begin[scan]; i < world.drive.scan_begin[scan + 1];
         ++i) {
      const Detection& detection = world.drive.detections[i];
      auto& seen = first[static_cast<std::size_t>(detection.identity)];
      if (!seen) seen = scan;
      if (*seen == scan || scan > *seen + kHidden) shown.detections.push_back(detection);
    }
    shown.scan_begin.push_back(static_cast<std::uint32_t>(shown.detections.size()));
  }
  world.drive = shown;
}

/// The landmarks of the map with an error of at most six standard deviations.
struct Map {
  std::size_t held = 0, near_truth = 0;
};

Map map_of(const SlamFilter& filter, const SmallWorld& world) {
  std::vector<std::optional<LandmarkEstimate>> map(kLandmarks);
  filter.map(map);
  Map result;
  for (std::size_t k = 0; k < map.size(); ++k) {
    if (!map[k]) continue;
    ++result.held;
    const Eigen::Vector2d error = map[k]->mean - world.itinerary.landmarks[k];
    if (error.dot(map[k]->covariance.llt().solve(error)) < 36.0) ++result.near_truth;
  }
  return result;
}

/// In one scan some landmarks are seen for the first time, while others are initialised.
void expect_a_good_map(const Sensor& sensor) {
  const SmallWorldSettings settings = large_world(sensor);
  SmallWorld world = small_world(settings);
  hide_after_first_detection(world);
  const FilterKind kind = ekf_slam_kind();
  const auto filter = kind.make({.belief = settings.noise,
                                 .association = {},
                                 .options = default_options(kind),
                                 .landmarks = kLandmarks});
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    EXPECT_EQ(filter->report().numerical_faults, 0U) << "scan " << scan;
  });
  const Map map = map_of(*filter, world);
  EXPECT_GT(map.held, 120U);
  EXPECT_EQ(map.near_truth, map.held);
}

TEST(DelayedInitialisation, OfBearingsHoldsInALargeMap) {
  expect_a_good_map({BearingSensor(), {}});
}

TEST(DelayedInitialisation, OfRangesHoldsInALargeMap) { expect_a_good_map({RangeSensor(), {}}); }

}  // namespace
}  // namespace montecarta::filters
