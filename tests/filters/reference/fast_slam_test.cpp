// SPDX-License-Identifier: BSD-3-Clause
#include "tests/filters/reference/fast_slam.hpp"

#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

namespace montecarta::filters::reference {
namespace {

/// So much noise on the motion that the controls alone soon lead astray.
Belief rough() {
  Belief belief;
  belief.control.sigma[0] = 1.0;
  belief.control.sigma[1] = 0.25;
  return belief;
}

FastSlamSettings settings_for(Association kind) {
  FastSlamSettings settings{.particles = 30, .belief = rough(), .landmarks = 20};
  settings.association.kind = kind;
  return settings;
}

/// Root of the mean squared position error over the scans [m].
double position_error(FastSlam&& filter, const SmallWorld& world) {
  double squares = 0.0;
  drive_through(filter, world, {}, [&](std::size_t s) {
    const Pose& truth = world.drive.truth[world.itinerary.scan_step[s]];
    squares += boxminus(truth, filter.estimate().spread.mean).head<2>().squaredNorm();
  });
  return std::sqrt(squares / static_cast<double>(world.itinerary.scans()));
}

/// Position error of the controls alone [m].
double dead_reckoning_error(const SmallWorld& world) {
  Pose pose;
  double squares = 0.0;
  for (std::size_t step = 0; step < world.itinerary.steps(); ++step) {
    pose = move(pose, world.drive.controls[step], world.itinerary.duration(step), Vehicle());
    squares += boxminus(world.drive.truth[step], pose).head<2>().squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(world.itinerary.steps()));
}

class ReferenceFastSlam : public ::testing::TestWithParam<Association> {};

TEST_P(ReferenceFastSlam, EveryFormBeatsDeadReckoning) {
  const SmallWorld world = small_world({.seed = 42, .scans = 150, .noise = rough()});
  const double alone = dead_reckoning_error(world);
  EXPECT_LT(position_error(FastSlam1(settings_for(GetParam())), world), 0.5 * alone);
  for (const Weight form : {Weight::closed, Weight::ratio, Weight::batch}) {
    EXPECT_LT(position_error(FastSlam2(settings_for(GetParam()), form), world), 0.5 * alone);
  }
}

INSTANTIATE_TEST_SUITE_P(KnownAndNearest, ReferenceFastSlam,
                         ::testing::Values(Association::known, Association::nearest));

TEST(ReferenceFastSlam2, AScanOfNothingLeavesTheParticlesUndrawn) {
  FastSlam2 filter(settings_for(Association::known), Weight::closed);
  const StepContext context(1, 0, 0, Parallel::serial());
  filter.start({});
  filter.predict(context, {3.0, 0.1}, 0.025);
  const Eigen::Matrix3d before = filter.population()[3].covariance;
  filter.update(context, {});
  EXPECT_GT(before.norm(), 0.0);
  EXPECT_EQ(filter.population()[3].covariance, before);
  EXPECT_NEAR(filter.report().ess, 30.0, 1e-9);
}

TEST(ReferenceFastSlam, ParticlesNeverJumpFartherThanTheVehicleCanMove) {
  const SmallWorld world = small_world({.seed = 43, .scans = 80});
  FastSlam2 filter({.particles = 30, .landmarks = 20}, Weight::closed);
  std::vector<Particle> before;
  int resamplings = 0;
  drive_through(filter, world, {}, [&](std::size_t s) {
    const auto& now = filter.population();
    for (std::size_t i = 0; i < now.size() && s > 0; ++i) {
      const Eigen::Vector3d way = now[i].pose - before[now[i].ancestor].pose;
      EXPECT_NEAR(way.head<2>().norm(), 0.6, 0.15) << "scan " << s << " particle " << i;
    }
    before = now;
    resamplings += filter.report().resampled;
  });
  EXPECT_GT(resamplings, 3);
}

}  // namespace
}  // namespace montecarta::filters::reference
