// SPDX-License-Identifier: BSD-3-Clause
// FastSLAM of sensors other than range and bearing at the pose.
#include "filters/fastslam/delayed_association.hpp"
#include "filters/fastslam/sigma_filters.hpp"
#include "filters/joint/joint_filter.hpp"
#include "tests/filters/same_runs.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/two_scans.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr Mounting kMounted{.forward = 0.8, .left = -0.3, .turn = 0.4};

FilterSetup setup_of(const FilterKind& kind, const SmallWorldSettings& settings,
                     const std::string& weights = {}) {
  std::map<std::string, std::string, std::less<>> special;
  if (kind.reports.particles) special = {{"particles", "30"}, {"weights", weights}};
  return {.belief = settings.noise,
          .association = {},
          .options = default_options(kind, special),
          .landmarks = 40};
}

SmallWorldSettings two_scans_of(const Sensor& sensor) {
  SmallWorldSettings settings = settings_of_two_scans();
  settings.noise.sensor = sensor;
  settings.noise.sigma_left = 0.2;
  return settings;
}

/// The law is FastSlam2.SeeingAgainFromAKnownPoseIsTheKalmanFiltersUpdate. A mounted one is updated
/// as the pose of the sensor, which differs in the second order.
TEST(SensorFastSlam, SeeingAgainFromAKnownPoseIsTheKalmanFiltersUpdate) {
  for (const Mounting& mounting : {Mounting(), kMounted}) {
    const SmallWorldSettings settings = two_scans_of({PositionSensor(), mounting});
    const double tolerance = mounting.is_none() ? 1e-12 : 1e-3;
    const SmallWorld world = drive_of_two_scans(settings);
    const auto kalman = make_ekf_slam(setup_of(ekf_slam_kind(), settings));
    const PoseMoments expected = after_two_scans(*kalman, world).spread;
    EXPECT_GE(kalman->report().nis_dof, 4U);
    const auto filter = fastslam2_kind().make(setup_of(fastslam2_kind(), settings, "closed"));
    const PoseMoments mixture = *after_two_scans(*filter, world).mixture;
    EXPECT_LT(boxminus(mixture.mean, expected.mean).norm(), tolerance);
    EXPECT_LT((mixture.covariance - expected.covariance).norm(), 0.1 * tolerance);
    EXPECT_NEAR(filter->report().log_likelihood, kalman->report().log_likelihood, 1e3 * tolerance);
    EXPECT_NEAR(filter->report().nis, kalman->report().nis, 1e3 * tolerance);
  }
}

/// The heading is nearly certain, so the model is linear and the batch equals the sequence.
TEST(SensorFastSlam, WeighsByTheBatchAsByTheSequenceWhereTheModelIsLinear) {
  const SmallWorldSettings settings = two_scans_of({PositionSensor(), kMounted});
  const SmallWorld world = drive_of_two_scans(settings);
  const auto log_likelihood = [&](const std::string& weights) {
    FilterSetup setup = setup_of(fastslam2_kind(), settings, weights);
    setup.belief.control.sigma[1] = 1e-7;
    const auto filter = fastslam2_kind().make(setup);
    after_two_scans(*filter, world);
    return filter->report().log_likelihood;
  };
  EXPECT_NEAR(log_likelihood("batch"), log_likelihood("closed"), 1e-3);
}

template <class Kind>
void expect_lanes_are_particles(const char* weights) {
  SmallWorldSettings settings = two_scans_of({Kind(), kMounted});
  settings.scans = 60;
  const SmallWorld world = small_world(settings);
  const FilterSetup setup = setup_of(fastslam2_kind(), settings, weights);
  const auto lanes = fastslam2_kind().make(setup);
  const auto scalar = make_fastslam2<double, OnMounting<Kind>>(setup);
  std::vector<PoseMoments> expected;
  drive_through(*scalar, world, {},
                [&](std::size_t) { expected.push_back(scalar->estimate().spread); });
  drive_through(*lanes, world, {}, [&](std::size_t scan) {
    EXPECT_LT(boxminus(lanes->estimate().spread.mean, expected[scan].mean).norm(), 1e-6)
        << weights << ", scan " << scan;
  });
  EXPECT_GT(lanes->report().map_size, 3.0);
  EXPECT_EQ(lanes->report().map_size, scalar->report().map_size);
}

TEST(SensorFastSlam, LanesAreParticlesOneByOne) {
  for (const char* weights : {"closed", "ratio", "batch"})
    expect_lanes_are_particles<PositionSensor>(weights);
  expect_lanes_are_particles<BearingSensor>("closed");
}

/// The reports of a filter on a drive with that mounting of the sensor.
PoseMoments driven(const FilterKind& kind, const Sensor& sensor, const SmallWorld& world) {
  SmallWorldSettings settings = two_scans_of(sensor);
  std::map<std::string, std::string, std::less<>> special{{"particles", "30"}};
  const auto filter = kind.make({.belief = settings.noise,
                                 .association = {.kind = Association::nearest},
                                 .options = default_options(kind, special),
                                 .landmarks = 40});
  drive_through(*filter, world, {}, [](std::size_t) {});
  return filter->estimate().spread;
}

/// A mounting of 1e-12 m goes the way of sensors that are mounted somewhere.
TEST(SensorFastSlam, AMountingOfNothingIsNoMounting) {
  SmallWorldSettings settings = two_scans_of({});
  settings.scans = 20;
  const SmallWorld world = small_world(settings);
  for (const FilterKind& kind : {fastslam1_kind(), fastslam2_kind(), ufastslam_kind()}) {
    const PoseMoments none = driven(kind, {}, world);
    const PoseMoments mounted = driven(kind, {RangeBearingSensor(), {.forward = 1e-12}}, world);
    EXPECT_LT(boxminus(mounted.mean, none.mean).norm(), 1e-8) << kind.name;
    EXPECT_LT((mounted.covariance - none.covariance).norm(), 1e-8) << kind.name;
  }
}

TEST(SensorFastSlam, FindsWhichLandmarkADetectionIs) {
  for (const SensorKind& sensor :
       {SensorKind(RangeBearingSensor()), SensorKind(PositionSensor())}) {
    SmallWorldSettings settings = two_scans_of({sensor, kMounted});
    settings.seed = 3;
    settings.landmarks = 20;
    settings.scans = 100;
    const SmallWorld world = small_world(settings);
    for (const FilterKind& kind : {fastslam1_kind(), fastslam2_kind(), ufastslam_kind()}) {
      const FilterSetup setup{.belief = settings.noise,
                              .association = {.kind = Association::nearest, .gate = 13.8},
                              .options = default_options(kind, {{"particles", "100"}}),
                              .landmarks = 20};
      const auto filter = kind.make(setup);
      AssociationCounts counts;
      drive_through(*filter, world, {},
                    [&](std::size_t) { add(filter->report().association, 1.0, counts); });
      EXPECT_GT(counts.correct, 20.0 * counts.wrong) << kind.name;
      EXPECT_GT(filter->report().map_size, 5.0) << kind.name;
      EXPECT_LT(filter->report().map_size, 20.5) << kind.name;
    }
  }
}

TEST(SensorFastSlam, GivesTheSameBitsOnAnyNumberOfThreads) {
  for (const Sensor& sensor : {Sensor{PositionSensor(), kMounted}, Sensor{BearingSensor(), {}},
                               Sensor{RangeSensor(), kMounted}}) {
    SmallWorldSettings settings = two_scans_of(sensor);
    settings.scans = 70;
    const SmallWorld world = small_world(settings);
    for (const FilterKind& kind : {fastslam1_kind(), fastslam2_kind(), ufastslam_kind()}) {
      const auto filter = kind.make({.belief = settings.noise,
                                     .association = {},
                                     .options = default_options(kind, {{"particles", "1100"}}),
                                     .landmarks = 40});
      drive_through(*filter, world, {}, [](std::size_t) {});
      EXPECT_GT(filter->report().map_size, 3.0);
      const ToldBits alone(*filter, 1100, 40);
      const Parallel threads(Backend::tbb, 3);
      drive_through(
          *filter, world, {}, [](std::size_t) {}, threads);
      EXPECT_TRUE(ToldBits(*filter, 1100, 40) == alone) << kind.name << ", " << name_of(sensor);
    }
  }
}

/// A pose and a landmark so far away that the nonlinear terms are negligible beside the noise.
TEST(SensorFastSlam, SigmaPointsOfALinearModelAreTheKalmanFilter) {
  SigmaPoints points({.motion = unscented_rule(5, 0.9, 2, 0),
                      .pose = unscented_rule(5, 0.9, 2, 0),
                      .landmark = unscented_rule(2, 0.9, 2, 0)},
                     {}, MapUncertainty::on);
  const PoseGaussian<double> pose{{1.0, 2.0, 0.7}, {1e-6, 3e-7, 2e-6, 1e-8, -2e-8, 1e-9}};
  const LandmarkGaussian<double> landmark{{30.0, 25.0}, {2e-5, 1e-5, 3e-5}};
  const auto compare = [&]<class Kind>(Kind, const Measurement<double>& seen) {
    const SensorNoise noise{1e-5, kHasTwoComponents<Kind> ? 2e-5 : 1.0};
    Evidence<double> evidence, expected_evidence;
    PoseGaussian<double> refined = pose, expected = pose;
    SigmaPointsOf<Kind>(points).refine(refined, landmark, seen, noise, AllLanes(), evidence);
    LinearisedSensor<Kind>().refine(expected, landmark, seen, noise, AllLanes(), expected_evidence);
    EXPECT_LT(boxminus(refined.mean, expected.mean).norm(), 1e-6) << Kind::kName;
    EXPECT_GT(boxminus(refined.mean, pose.mean).norm(), 2e-6) << Kind::kName;
    EXPECT_LT((symmetric(refined.covariance) - symmetric(expected.covariance)).norm(), 1e-11);
    EXPECT_NEAR(evidence.log_density(), expected_evidence.log_density(), 1e-2) << Kind::kName;
    LandmarkGaussian<double> moved = landmark, kalman = landmark;
    const auto v =
        SigmaPointsOf<Kind>(points).update(moved, pose.mean, seen, noise, AllLanes(), evidence);
    LinearisedSensor<Kind>().update(kalman, pose.mean, seen, noise, AllLanes(), evidence);
    EXPECT_NEAR(moved.mean.x, kalman.mean.x, 1e-5) << Kind::kName;
    EXPECT_NEAR(moved.mean.y, kalman.mean.y, 1e-5) << Kind::kName;
    EXPECT_NEAR(moved.covariance.xy, kalman.covariance.xy, 1e-9) << Kind::kName;
    EXPECT_LT(kalman.covariance.xx, 2e-5) << Kind::kName;
    EXPECT_GT(v.S.xx, noise.first) << Kind::kName;
  };
  const auto exact = sight(PositionSensor(), pose.mean, landmark.mean).predicted;
  compare(PositionSensor(), {exact.first + 0.003, exact.second - 0.004});
  compare(BearingSensor(), {std::atan2(exact.second, exact.first) + 0.002, 0.0});
  compare(RangeSensor(), {std::hypot(exact.first, exact.second) + 0.004, 0.0});
}

}  // namespace
}  // namespace montecarta::filters
