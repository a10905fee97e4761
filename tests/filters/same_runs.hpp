// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/records/columns.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

/// Comparisons of two implementations of one filter.
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

/// Expects the same estimates and reports of two implementations of one filter after every scan;
/// poses to `tolerance` [m, rad].
inline void expect_same_run(SlamFilter& one, SlamFilter& other, const SmallWorld& world,
                            double tolerance) {
  std::vector<PoseEstimate> estimates;
  std::vector<ScanReport> reports;
  double compared = 0.0;
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
    compared += now.nis;
    EXPECT_NEAR(now.nis, reports[scan].nis, 1e3 * tolerance * (1 + reports[scan].nis));
    EXPECT_EQ(now.nis_dof, reports[scan].nis_dof);
  });
  EXPECT_GT(compared, 0.0) << "no NIS was compared";
}

/// Two makes of one filter say the same after every step, between scans as well.
inline void expect_same_steps(SlamFilter& one, SlamFilter& other, const SmallWorld& world,
                              double tolerance, const Pose& start = {}) {
  start_in(world, start, one), start_in(world, start, other);
  for (std::uint32_t step = 0, scan = 0; step < world.itinerary.steps(); ++step) {
    const StepContext context(world.seed, 0, step, Parallel::serial());
    for (SlamFilter* filter : {&one, &other}) {
      filter->predict(context, world.drive.controls[step], world.itinerary.duration(step));
    }
    expect_near(one.estimate(), other.estimate(), tolerance);
    if (world.itinerary.scan_step[scan] != step) continue;
    for (SlamFilter* filter : {&one, &other}) update_with_scan(*filter, context, world, scan);
    ++scan;
  }
}

/// Gathers numbers bit by bit, so that NaN equals NaN and nothing is near enough.
class ToldBits {
 public:
  /// All that `filter` tells after a scan; it has as many particles, or 0.
  ToldBits(const SlamFilter& filter, std::size_t particles, std::size_t landmarks) {
    add(filter.estimate());
    add(filter.report());
    add_particles(filter, particles);
    std::vector<std::optional<LandmarkEstimate>> map(landmarks);
    filter.map(map);
    for (const auto& landmark : map) {
      add(static_cast<double>(landmark.has_value()));
      if (!landmark) continue;
      add_all(landmark->mean.reshaped()), add_all(landmark->covariance.reshaped());
    }
  }
  explicit ToldBits(const PoseEstimate& estimate) { add(estimate); }
  friend bool operator==(const ToldBits&, const ToldBits&) = default;

 private:
  void add(double number) { bits_.push_back(std::bit_cast<std::uint64_t>(number)); }
  void add_all(const auto& numbers) {
    for (const double number : numbers) add(number);
  }
  void add(const PoseMoments& m) {
    add(m.mean.x), add(m.mean.y), add(m.mean.heading);
    add_all(m.covariance.reshaped());
  }
  void add(const PoseEstimate& estimate) {
    add(estimate.spread);
    if (estimate.mixture) add(*estimate.mixture);
  }
  void add(const ScanReport& report) {
    for (const engine::ColumnKind& column : engine::column_table()) {
      if (column.of_report != nullptr) add(column.of_report(report));
    }
  }
  void add_particles(const SlamFilter& filter, std::size_t particles) {
    std::vector<double> poses(3 * particles), log_weights(particles);
    std::vector<std::uint32_t> ancestors(particles);
    filter.particles({poses, log_weights, ancestors});
    add_all(poses), add_all(log_weights);
    for (const std::uint32_t ancestor : ancestors) bits_.push_back(ancestor);
  }

  std::vector<std::uint64_t> bits_;
};

}  // namespace montecarta::filters
