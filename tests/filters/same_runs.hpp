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

/// Gathers numbers bit by bit, so that NaN equals NaN and nothing is near enough.
class ToldBits {
 public:
  /// All that `filter` tells after a scan; it has as many particles, or 0.
  ToldBits(const SlamFilter& filter, std::size_t particles, std::size_t landmarks) {
    write_columns(filter.estimate());
    write_columns(filter.report());
    write_particle_columns(filter, particles);
    std::vector<std::optional<LandmarkEstimate>> map(landmarks);
    filter.map(map);
    for (const auto& landmark : map) {
      write_columns(static_cast<double>(landmark.has_value()));
      if (!landmark) continue;
      tell_all(landmark->mean.reshaped()), tell_all(landmark->covariance.reshaped());
    }
  }
  explicit ToldBits(const PoseEstimate& estimate) { write_columns(estimate); }
  friend bool operator==(const ToldBits&, const ToldBits&) = default;

 private:
  void write_columns(double number) { bits_.push_back(std::bit_cast<std::uint64_t>(number)); }
  void tell_all(const auto& numbers) {
    for (const double number : numbers) write_columns(number);
  }
  void write_columns(const PoseMoments& m) {
    write_columns(m.mean.x), write_columns(m.mean.y), write_columns(m.mean.heading);
    tell_all(m.covariance.reshaped());
  }
  void write_columns(const PoseEstimate& estimate) {
    write_columns(estimate.spread);
    if (estimate.mixture) write_columns(*estimate.mixture);
  }
  void write_columns(const ScanReport& report) {
    for (const engine::ColumnKind& column : engine::column_table()) {
      if (column.of_report != nullptr) write_columns(column.of_report(report));
    }
  }
  void write_particle_columns(const SlamFilter& filter, std::size_t particles) {
    std::vector<double> poses(3 * particles), log_weights(particles);
    std::vector<std::uint32_t> ancestors(particles);
    filter.particles({poses, log_weights, ancestors});
    tell_all(poses), tell_all(log_weights);
    for (const std::uint32_t ancestor : ancestors) bits_.push_back(ancestor);
  }

  std::vector<std::uint64_t> bits_;
};

}  // namespace montecarta::filters
