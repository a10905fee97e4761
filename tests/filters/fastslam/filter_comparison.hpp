// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/factory.hpp"
#include "tests/filters/reference/fast_slam2.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

/// A filter of the family in one setting, and what it means that two of its makes are equal.
namespace montecarta {

struct Variant {
  std::string filter;
  std::string weights = "closed";
  Association association = Association::known;
  std::size_t particles = 13;  ///< not a multiple of the lanes
  std::map<std::string, std::string, std::less<>> options = {};

  friend std::ostream& operator<<(std::ostream& out, const Variant& v) {
    out << v.filter << '_' << v.weights
        << (v.association == Association::known ? "_known_" : "_nearest_") << v.particles;
    for (const auto& [name, value] : v.options) {
      out << '_' << name << '_';
      for (const char letter : value) out << (letter == '.' ? 'p' : letter);  // a test's name
    }
    return out;
  }
};

inline const FilterKind& kind_of(const Variant& v) {
  const auto kinds = filter_kinds();
  return *std::find_if(kinds.begin(), kinds.end(),
                       [&](const FilterKind& kind) { return kind.name == v.filter; });
}

inline FilterSetup setup_of(const Variant& v, const SmallWorldSettings& world) {
  auto values = v.options;
  for (const FilterOption& option : kind_of(v).options) {
    values.try_emplace(option.name, option.fallback);
  }
  values["particles"] = std::to_string(v.particles);
  if (values.contains("weights")) values["weights"] = v.weights;
  return {.belief = world.noise,
          .association = {.kind = v.association},
          .options = FilterOptions(values),
          .landmarks = world.landmarks};
}

/// As users get it: over lanes.
inline std::unique_ptr<SlamFilter> make_production(const Variant& v,
                                                   const SmallWorldSettings& world) {
  return kind_of(v).make(setup_of(v, world));
}

inline reference::FastSlamSettings reference_settings(const Variant& v,
                                                      const SmallWorldSettings& world) {
  return {.particles = v.particles,
          .belief = world.noise,
          .association = {.kind = v.association},
          .landmarks = world.landmarks};
}
inline reference::Weight reference_weight(const Variant& v) {
  if (v.weights == "ratio") return reference::Weight::ratio;
  return v.weights == "batch" ? reference::Weight::batch : reference::Weight::closed;
}

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
                              double tolerance) {
  one.start(Pose()), other.start(Pose());
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

}  // namespace montecarta
