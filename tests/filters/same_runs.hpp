// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <vector>

/// What it means that two makes of one filter are equal.
namespace montecarta::filters {

inline void expect_near(const PoseMoments& a, const PoseMoments& b, double tolerance) {
  EXPECT_LT(boxminus(a.mean, b.mean).norm(), tolerance);
  EXPECT_LT((a.covariance - b.covariance).norm(), tolerance);
}
inline void expect_near(const PoseEstimate& a, const PoseEstimate& b, double tolerance) {
  expect_near(a.spread, b.spread, tolerance);
  ASSERT_EQ(a.mixture.has_value(), b.mixture.has_value());
  if (a.mixture) expect_near(*a.mixture, *b.mixture, tolerance);
}

/// Two makes of one filter say the same after every scan, pose to `tolerance` [m, rad].
inline void expect_same_run(SlamFilter& one, SlamFilter& other, const SmallWorld& world,
                            double tolerance) {
  std::vector<PoseEstimate> estimates;
  std::vector<ScanReport> reports;
  drive_through(one, world, Pose(), [&](std::size_t) {
    estimates.push_back(one.estimate());
    reports.push_back(one.report());
  });
  drive_through(other, world, Pose(), [&](std::size_t scan) {
    const ScanReport& now = other.report();
    expect_near(other.estimate(), estimates[scan], tolerance);
    EXPECT_NEAR(now.ess, reports[scan].ess, 1e3 * tolerance);
    EXPECT_NEAR(now.log_likelihood, reports[scan].log_likelihood, 1e3 * tolerance);
    EXPECT_EQ(now.resampled, reports[scan].resampled);
    if (now.nis == 0.0) return;  // the plain references do not tell it
    EXPECT_NEAR(now.nis, reports[scan].nis, 1e3 * tolerance * (1 + reports[scan].nis));
  });
}

/// Two makes of one filter say the same after every step, between scans as well.
inline void expect_same_steps(SlamFilter& one, SlamFilter& other, const SmallWorld& world,
                              double tolerance, const Pose& start = {}) {
  one.start(start), other.start(start);
  for (std::uint32_t step = 0, scan = 0; step < world.itinerary.steps(); ++step) {
    const StepContext context(world.seed, 0, step, Parallel::serial());
    for (SlamFilter* filter : {&one, &other}) {
      filter->predict(context, world.drive.controls[step], world.itinerary.duration(step));
    }
    expect_near(one.estimate(), other.estimate(), tolerance);
    if (world.itinerary.scan_step[scan] != step) continue;
    for (SlamFilter* filter : {&one, &other}) filter->update(context, world.drive.scan(scan));
    ++scan;
  }
}

}  // namespace montecarta::filters
