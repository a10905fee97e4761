// SPDX-License-Identifier: BSD-3-Clause
// The laws of every filter with its default options.
#include "filters/factory.hpp"
#include "tests/filters/laws/filters_held_to_laws.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <barrier>
#include <cmath>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

std::unique_ptr<SlamFilter> make_default(const FilterKind& kind, std::size_t particles,
                                         const SmallWorldSettings& world,
                                         Association association = Association::known,
                                         OptionTexts special = {}) {
  special["particles"] = std::to_string(particles);
  return make_filter(kind, world, special, association);
}

/// Every filter there is, as a newcomer would get it.
class EveryFilter : public testing::TestWithParam<FilterKind> {};

/// The pose, a scan later and without noise, of a particle at `pose` (x, y, heading).
Pose driven_on(const double* pose, const SmallWorldSettings& settings) {
  Pose next{pose[0], pose[1], pose[2]};
  for (std::size_t k = 0; k < settings.steps_per_scan; ++k) {
    next = move(next, Control{3.0, 0.15}, 0.025, settings.noise.vehicle);
  }
  return next;
}

TEST_P(EveryFilter, ReportsTheColumnsOfItsOwnThatItDeclares) {
  const SmallWorldSettings settings{.scans = 3};
  const auto filter = make_default(GetParam(), 5, settings);
  Capabilities reports = GetParam().reports;
  if (GetParam().restrict_reports)
    GetParam().restrict_reports(setup_for(GetParam(), settings), reports);
  drive_through(*filter, small_world(settings), Pose(), [&](std::size_t) {
    EXPECT_EQ(filter->report().own.size(), reports.own_columns.size());
  });
}

/// Every filter that has a genealogy.
class EveryParticleFilter : public testing::TestWithParam<FilterKind> {};

TEST_P(EveryParticleFilter, WalkingBackThroughAncestorsNeverJumpsFartherThanTheVehicleCanMove) {
  // The sensor is so rough that the cloud grows metres wide: a wrong ancestor stands too far away.
  // It sees far, so no scan is empty, and poses are drawn after every 0.2 s.
  const std::size_t n = 50;
  const SmallWorldSettings settings{.landmarks = 6,
                                    .scans = 200,
                                    .max_range = 80.0,
                                    .noise = {.sigma_range = 1.0, .sigma_bearing = 0.2}};
  const SmallWorld world = small_world(settings);
  const auto filter = make_default(GetParam(), n, settings);
  std::vector<double> poses(3 * n), before(3 * n, 0.0), log_weights(n);
  std::vector<std::uint32_t> ancestors(n);
  bool resampled = false;
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    filter->particles({poses, log_weights, ancestors});
    for (std::size_t i = 0; i < n; ++i) {
      const Pose pose{poses[3 * i], poses[3 * i + 1], poses[3 * i + 2]};
      const auto noise = boxminus(pose, driven_on(&before[3 * ancestors[i]], settings));
      ASSERT_LT(noise.head<2>().norm(), 0.12) << "scan " << scan << ", particle " << i;
      ASSERT_LT(std::abs(noise(2)), 0.02) << "scan " << scan << ", particle " << i;
    }
    resampled = resampled || filter->report().resampled;
    before = poses;
  });
  EXPECT_TRUE(resampled) << "the law was not put to the test";
}

TEST_P(EveryFilter, StandsStillAtTheOriginOfTheMapWithoutHarm) {
  const SmallWorldSettings settings;
  for (const auto association : {Association::known, Association::nearest}) {
    const auto filter = make_default(GetParam(), 9, settings, association);
    filter->start(Pose());
    const std::vector<Detection> scan{{10.0, 0.3, 0}, {15.0, -0.4, 1}};
    for (std::uint32_t step = 0; step < 20; ++step) {
      const StepContext context(1, 0, step, Parallel::serial());
      filter->predict(context, {0.0, 0.0}, 0.2);
      filter->update(context, scan);
      const PoseMoments now = filter->estimate().spread;
      ASSERT_LT(boxminus(now.mean, Pose()).norm(), 1.5);  // five times its random walk
      ASSERT_TRUE(now.covariance.allFinite());
    }
  }
}

/// Returns whether a filter adds noise of its own to the motion at every scan, and says so.
bool declares_a_noise_floor(const FilterKind& kind) {
  return std::any_of(kind.options.begin(), kind.options.end(),
                     [](const Parameter& option) { return option.key == "kernel_floor_xy"; });
}

TEST_P(EveryFilter, LeavesADetectionOutWhoseLandmarkItStandsOn) {
  const SmallWorldSettings settings;
  const bool has_floor = declares_a_noise_floor(GetParam());  // then it steps off the landmark
  const auto filter = make_default(GetParam(), 9, settings);
  filter->start(Pose());
  for (std::uint32_t step = 0; step < 5; ++step) {
    const StepContext context(1, 0, step, Parallel::serial());
    filter->predict(context, {0.0, 0.0}, 0.0);  // no time, so no noise either
    filter->update(context, std::vector<Detection>{{1e-9, 0.0, 0}});
    ASSERT_LT(boxminus(filter->estimate().spread.mean, Pose()).norm(), has_floor ? 0.1 : 1e-6);
  }
  if (!has_floor) {
    EXPECT_EQ(filter->report().numerical_faults, GetParam().reports.particles ? 9U : 0U);
  }
}

TEST_P(EveryFilter, ForgetsADifferentRunBefore) {
  const SmallWorldSettings first_settings{.seed = 5, .scans = 70}, settings;
  const SmallWorld first = small_world(first_settings), world = small_world(settings);
  for (const auto association : {Association::known, Association::nearest}) {
    const auto used = make_default(GetParam(), 11, settings, association);
    const auto fresh = make_default(GetParam(), 11, settings, association);
    drive_through(*used, first);
    const std::size_t n = GetParam().reports.particles ? 11 : 0;
    EXPECT_TRUE(told(*used, n, world) == told(*fresh, n, world));
  }
}

/// All that a filter tells after every scan, and its estimate after every prediction.
std::vector<ToldBits> told_at_every_step(SlamFilter& filter, std::size_t particles,
                                         const SmallWorld& world, const Parallel& parallel) {
  std::vector<ToldBits> bits;
  filter.start({});
  for (std::uint32_t step = 0, scan = 0; step < world.itinerary.steps(); ++step) {
    const StepContext context(world.seed, 0, step, parallel);
    filter.predict(context, world.drive.controls[step], world.itinerary.duration(step));
    bits.emplace_back(filter.estimate());
    if (world.itinerary.scan_step[scan] != step) continue;
    filter.update(context, world.drive.scan(scan++));
    bits.emplace_back(filter, particles, world.itinerary.landmarks.size());
    rouse(parallel);
  }
  return bits;
}

TEST_P(EveryFilter, GivesTheSameBitsOnAnyNumberOfThreads) {
  const SmallWorldSettings settings{.scans = 3};
  const SmallWorld world = small_world(settings);
  // More than two tasks, those of a step and of sums included; a plain filter has but one.
  const std::size_t particles = GetParam().name.starts_with("plain_") ? 50 : 2100;
  const std::size_t n = GetParam().reports.particles ? particles : 0;
  for (const auto association : {Association::known, Association::nearest}) {
    const auto filter = make_default(GetParam(), particles, settings, association);
    const auto alone = told_at_every_step(*filter, n, world, Parallel(Backend::serial, 1));
    for (const Backend backend : {Backend::tbb, Backend::openmp}) {
      const auto bits = told_at_every_step(*filter, n, world, Parallel(backend, 3));
      EXPECT_TRUE(bits == alone) << (backend == Backend::tbb ? "TBB" : "OpenMP");
    }
  }
}

TEST_P(EveryFilter, GivesTheSameBitsOnEveryThreadWhileOthersRun) {
  const SmallWorldSettings settings{.scans = 8};
  const SmallWorld world = small_world(settings);
  const std::size_t particles = GetParam().name.starts_with("plain_") ? 50 : 300;
  const std::size_t n = GetParam().reports.particles ? particles : 0;
  const auto make = [&] {
    return make_default(GetParam(), particles, settings, Association::known);
  };
  const auto alone = told(*make(), n, world);
  const Parallel threads(Backend::tbb, 3);
  std::vector<std::vector<ToldBits>> at_once(3);
  std::barrier together(3);
  threads.for_each(3, [&](std::size_t thread) {
    const auto filter = make();
    together.arrive_and_wait();
    at_once[thread] = told(*filter, n, world);
  });
  for (const auto& one : at_once) EXPECT_TRUE(one == alone);
}

TEST_P(EveryFilter, TurningTheWorldTurnsTheEstimate) {
  const SmallWorldSettings settings;
  const auto filter =
      make_default(GetParam(), 30, settings, Association::known, {{"moments", "pushed"}});
  expect_turns_with_the_world(*filter, small_world(settings));
}

INSTANTIATE_TEST_SUITE_P(All, EveryParticleFilter,
                         testing::ValuesIn(filters_held_to_laws([](const FilterKind& kind) {
                           return kind.reports.particles;
                         })),
                         [](const auto& instance) { return instance.param.name; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryParticleFilter);

INSTANTIATE_TEST_SUITE_P(All, EveryFilter, testing::ValuesIn(filters_held_to_laws()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace montecarta::filters
