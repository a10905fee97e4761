// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/small_world.hpp"

/// The first scan that sees landmarks again: a case in which FastSLAM II and the Kalman filter are
/// one.
namespace montecarta::filters {

inline SmallWorldSettings settings_of_two_scans() { return {.seed = 77, .landmarks = 40}; }

/// Two scans with a short drive between, the first one from the known start. The filter is given a
/// speed of 3 m/s and a steering angle of 0.15 rad; the vehicle is driven by `driven`.
inline SmallWorld drive_of_two_scans(const SmallWorldSettings& settings = settings_of_two_scans(),
                                     const Control& driven = {3.0, 0.15}) {
  SmallWorld world{.itinerary = {}, .drive = {}, .seed = settings.seed};
  place_landmarks(settings, world);
  world.drive.scan_begin.push_back(0);
  look_around(settings, 0, Pose{}, world);
  Pose truth;
  for (int step = 0; step < 8; ++step) truth = move(truth, driven, 0.025, Vehicle());
  look_around(settings, 8, truth, world);
  return world;
}

/// The estimate of a filter after both.
inline PoseEstimate after_two_scans(SlamFilter& filter, const SmallWorld& world) {
  filter.start({});
  filter.update(StepContext(77, 0, 0, Parallel::serial()), world.drive.scan(0));
  for (std::uint32_t step = 1; step <= 8; ++step) {
    filter.predict(StepContext(77, 0, step, Parallel::serial()), {3.0, 0.15}, 0.025);
  }
  filter.update(StepContext(77, 0, 8, Parallel::serial()), world.drive.scan(1));
  return filter.estimate();
}

}  // namespace montecarta::filters
