// SPDX-License-Identifier: BSD-3-Clause
// What no detection can tell: how path and map are turned as a whole.
#include "filters/joint/joint_filters.hpp"
#include "tests/filters/default_options.hpp"
#include "tests/filters/reference/fej_ekf_slam.hpp"
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
  const auto filter =
      one.kind.make({.belief = settings.noise,
                     .association = {},
                     .options = default_options(one.kind, {{"iterations", one.iterations}}),
                     .landmarks = settings.landmarks});
  double before = 0.0, dof = 0.0;
  drive_through(*filter, small_world(settings), {4.0, -3.0, 0.5}, [&](std::size_t scan) {
    const double now = filter->report().rotation_information;
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
  Belief belief;
  belief.sensor.kind = BearingSensor();
  const auto filter = make_ekf_slam({.belief = belief,
                                     .association = {},
                                     .options = default_options(ekf_slam_kind()),
                                     .landmarks = 1});
  const Detection one{.values = {0.3}, .identity = 0};
  filter->start({});
  filter->update(StepContext(1, 0, 0, Parallel::serial()), Scan(&one, 1));
  EXPECT_TRUE(std::isnan(filter->report().rotation_information));
}

/// The literal filter behind the signature of a SlamFilter.
struct FejRunner {
  reference::FejEkfSlam filter;
  void start(const Pose& pose) { filter.start(pose); }
  void predict(const StepContext&, const Control& control, double duration) {
    filter.predict(control, duration);
  }
  void update(const StepContext&, Scan scan) { filter.update(scan); }
};

class AsPublished : public testing::TestWithParam<FilterKind> {};

TEST_P(AsPublished, EqualsTheLiteralFilter) {
  const FilterKind& kind = GetParam();
  const SmallWorld world = small_world({.seed = 5, .landmarks = 21, .scans = 250});
  std::vector<Eigen::Vector3d> means;
  std::vector<Eigen::Matrix3d> covariances;
  FejRunner literal{{Belief{}, kind.name == "oc_ekf_slam"}};
  drive_through(literal, world, {4.0, -3.0, 0.5}, [&](std::size_t) {
    means.push_back(literal.filter.mean.head<3>());
    covariances.push_back(literal.filter.covariance.topLeftCorner<3, 3>());
  });
  const auto filter = kind.make(
      {.belief = {}, .association = {}, .options = default_options(kind), .landmarks = 21});
  drive_through(*filter, world, {4.0, -3.0, 0.5}, [&](std::size_t s) {
    const PoseMoments& pose = filter->estimate().spread;
    const Pose expected{means[s](0), means[s](1), means[s](2)};
    EXPECT_LT(boxminus(pose.mean, expected).norm(), 1e-9) << "scan " << s;
    EXPECT_LT((pose.covariance - covariances[s]).norm(), 1e-9) << "scan " << s;
  });
}

INSTANTIATE_TEST_SUITE_P(All, AsPublished, testing::Values(fej_ekf_slam_kind(), oc_ekf_slam_kind()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace montecarta::filters
