// SPDX-License-Identifier: BSD-3-Clause
// No detection is informative about the turn of path and map as a whole.
#include "filters/joint/joint_filter.hpp"
#include "tests/filters/consistent_anees.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

struct Case {
  FilterKind kind;
  std::string iterations = "0";
  SensorKind sensor = RangeBearingSensor();
};

/// After 250 scans, in which landmarks are seen again; the sensor is rough, so estimates move.
double information_of(const Case& one) {
  SmallWorldSettings settings{.seed = 5, .landmarks = 21, .scans = 250};
  settings.noise.sigma_bearing = 0.1;
  settings.noise.sensor.kind = one.sensor;
  const auto filter = make_filter(one.kind, settings, {{"iterations", one.iterations}});
  double before = 0.0, dof = 0.0;
  drive_through(*filter, small_world(settings), {4.0, -3.0, 0.5}, [&](std::size_t scan) {
    const double now = filter->report().own.front();
    EXPECT_GE(now, before) << "scan " << scan;
    before = now;
    dof += filter->report().nis_dof;
  });
  EXPECT_GT(dof, 1000.0);
  return before;
}

class RightUnobservableDirections : public testing::TestWithParam<Case> {};

TEST_P(RightUnobservableDirections, LearnNothingOfTheHeadingOfTheWhole) {
  EXPECT_LT(information_of(GetParam()), 1e-18);
}

INSTANTIATE_TEST_SUITE_P(All, RightUnobservableDirections,
                         testing::Values(Case{fej_ekf_slam_kind()}, Case{oc_ekf_slam_kind()},
                                         Case{robocentric_ekf_slam_kind()}, Case{riekf_slam_kind()},
                                         Case{riekf_slam_kind(), "5"},
                                         Case{fej_ekf_slam_kind(), "0", PositionSensor()},
                                         Case{oc_ekf_slam_kind(), "0", PositionSensor()},
                                         Case{riekf_slam_kind(), "0", PositionSensor()}));

TEST(RotationInformation, EkfSlamTakesDetectionsForSomeOfIt) {
  EXPECT_GT(information_of({ekf_slam_kind()}), 1.0);
  EXPECT_GT(information_of({ekf_slam_kind(), "5"}), 1.0);
}

TEST(RotationInformation, IsNotToldOfASensorThatDoesNotFixLandmarks) {
  SmallWorldSettings settings{.landmarks = 1};
  settings.noise.sensor.kind = BearingSensor();
  const auto filter = make_filter(ekf_slam_kind(), settings);
  const Detection one{.values = {0.3}, .identity = 0};
  filter->start({});
  filter->update(StepContext(1, 0, 0, Parallel::serial()), Scan(&one, 1));
  EXPECT_TRUE(filter->report().own.empty());
}

TEST(RiekfSlam, IsEkfSlamUntilALandmarkIsSeenAgain) {
  const SmallWorld world = small_world({.seed = 6, .scans = 3});
  const auto plain = make_filter(ekf_slam_kind(), {});
  const auto invariant = make_filter(riekf_slam_kind(), {});
  const auto advance = [&](SlamFilter& filter, std::uint32_t step) {
    filter.predict(StepContext(6, 0, step, Parallel::serial()), world.drive.controls[step], 0.025);
    return filter.estimate().spread;
  };
  const auto expect_equal = [&](std::uint32_t step) {
    const PoseMoments a = advance(*plain, step), b = advance(*invariant, step);
    EXPECT_EQ(boxminus(a.mean, b.mean).norm(), 0.0) << "step " << step;
    EXPECT_EQ(a.covariance, b.covariance) << "step " << step;
  };
  plain->start({});
  invariant->start({});
  for (std::uint32_t step = 0; step < 8; ++step) expect_equal(step);
  for (auto* filter : {plain.get(), invariant.get()}) {
    filter->update(StepContext(6, 0, 7, Parallel::serial()), world.drive.scan(0));
  }
  for (std::uint32_t step = 8; step < 16; ++step) expect_equal(step);
}

/// Noise that bends the models: here EKF-SLAM and RI-EKF-SLAM part.
Belief rough() { return {.control = {.sigma = {0.3, 0.1}}, .sigma_bearing = 0.05}; }

/// The share of the heading's variance that is left to a vehicle that drove blindly, stood, and
/// looked a hundred times at landmarks it had never seen before: nothing of that tells where x
/// points.
double heading_variance_left(const FilterKind& kind) {
  const auto filter = make_filter(kind, {.landmarks = 3, .noise = rough()});
  filter->start({5.0, 2.0, 1.0});
  RngStream draw({.seed = 12, .purpose = Draw::test});
  const StepContext context(12, 0, 0, Parallel::serial());
  for (int step = 0; step < 200; ++step) filter->predict(context, {3.0, 0.1}, 0.025);
  const double before = filter->estimate().spread.covariance(2, 2);
  for (int look = 0; look < 100; ++look) {
    std::vector<Detection> scan{{10.0, 0.5, 0}, {15.0, -0.6, 1}, {20.0, 0.1, 2}};
    for (Detection& detection : scan) {
      detection[0] += rough().sigma_range * draw.normal();
      detection[1] += rough().sigma_bearing * draw.normal();
    }
    filter->update(context, scan);
  }
  return filter->estimate().spread.covariance(2, 2) / before;
}

TEST(RiekfSlam, AStandingVehicleLearnsNothingOfItsHeadingFromNewLandmarks) {
  EXPECT_NEAR(heading_variance_left(riekf_slam_kind()), 1.0, 1e-12);
  EXPECT_LT(heading_variance_left(ekf_slam_kind()), 0.7);  // takes the jitter of its map for news
}

TEST(RiekfSlam, StaysConsistentWhereEkfSlamDoesNot) {
  constexpr std::uint64_t kRuns = 200;
  const SmallWorldSettings settings{.seed = 900, .scans = 150, .noise = rough()};
  const auto anees = [&](const FilterKind& kind) {
    return final_errors(*make_filter(kind, settings), settings, kRuns).anees;
  };
  EXPECT_TRUE(is_consistent(anees(riekf_slam_kind()), kRuns));
  EXPECT_GT(anees(ekf_slam_kind()), 5.9);  // half as much again as the end of the band
}

}  // namespace
}  // namespace montecarta::filters
