// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/same_runs.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <barrier>
#include <ostream>
#include <vector>

namespace montecarta::filters {

/// So that a test is listed by the filter's name.
inline void PrintTo(const FilterKind& kind, std::ostream* out) { *out << kind.name; }

/// The filters that another source tree added, where it added any; else all that are shipped.
inline std::vector<FilterKind> filters_held_to_laws() {
  const auto added = added_filter_kinds();
  const auto kinds = added.empty() ? filter_kinds() : added;
  return {kinds.begin(), kinds.end()};
}

/// Those of them for which `condition(kind)` holds.
template <class Condition>
std::vector<FilterKind> filters_held_to_laws(const Condition& condition) {
  std::vector<FilterKind> kinds = filters_held_to_laws();
  std::erase_if(kinds, [&](const FilterKind& kind) { return !condition(kind); });
  return kinds;
}

/// Returns whether a filter takes this sensor, as it is mounted.
inline bool takes(const FilterKind& kind, const Sensor& sensor) {
  if (kind.sensors.empty()) return true;
  return (sensor.mounting.is_none() || kind.takes_mountings) &&
         std::ranges::find(kind.sensors, name_of(sensor)) != kind.sensors.end();
}

/// Returns when all threads are awake, so that they share the next loop.
inline void rouse(const Parallel& parallel) {
  std::barrier together(parallel.threads());
  parallel.for_each(static_cast<std::size_t>(parallel.threads()),
                    [&](std::size_t) { together.arrive_and_wait(); });
}

/// All that a filter tells after every scan, with loops over particles spread over `parallel`.
inline std::vector<ToldBits> told(SlamFilter& filter, std::size_t particles,
                                  const SmallWorld& world,
                                  const Parallel& parallel = Parallel::serial()) {
  std::vector<ToldBits> bits;
  const auto listen = [&](std::size_t) {
    bits.emplace_back(filter, particles, world.itinerary.landmarks.size());
    if (parallel.threads() > 1) rouse(parallel);
  };
  drive_through(filter, world, Pose(), listen, parallel);
  return bits;
}

/// `now` is `was` in the world turned and shifted as `start`.
inline void expect_turned(const PoseMoments& now, const PoseMoments& was, const Pose& start) {
  EXPECT_LT(boxminus(now.mean, turned(was.mean, start)).norm(), 1e-6);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(start.heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_LT((now.covariance - turn * was.covariance * turn.transpose()).norm(), 1e-7);
}

inline void expect_turns_with_the_world(SlamFilter& filter, const SmallWorld& world) {
  const Pose start{-30.0, 50.0, 2.0};
  std::vector<PoseEstimate> unturned;
  drive_through(filter, world, Pose(), [&](std::size_t) { unturned.push_back(filter.estimate()); });
  drive_through(filter, turned(world, start), start, [&](std::size_t scan) {
    SCOPED_TRACE(testing::Message() << "scan " << scan);
    const PoseEstimate now = filter.estimate(), &was = unturned[scan];
    expect_turned(now.spread, was.spread, start);
    ASSERT_EQ(now.mixture.has_value(), was.mixture.has_value());
    if (now.mixture) expect_turned(*now.mixture, *was.mixture, start);
  });
}

}  // namespace montecarta::filters
