// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "filters/joint/joint_belief.hpp"
#include "filters/joint/joint_filter.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

FilterSetup ekf_setup(std::size_t landmarks, Association kind = Association::known) {
  return setup_for(ekf_slam_kind(), {.landmarks = landmarks}, {}, kind);
}

TEST(EkfSlam, RoomForLandmarksIsNoLimit) {
  const SmallWorld world = small_world({.seed = 9, .landmarks = 37});
  const auto roomy = make_ekf_slam(ekf_setup(37));
  const auto tight = make_ekf_slam(ekf_setup(1));
  const auto expected = estimates_of(*roomy, world), found = estimates_of(*tight, world);
  for (std::size_t s = 0; s < expected.size(); ++s) {
    EXPECT_EQ(boxminus(found[s].mean, expected[s].mean).norm(), 0.0) << "scan " << s;
  }
}

TEST(EkfSlam, NearestNeighbourFindsTheTrueLandmarksWhereTheyStandApart) {
  SmallWorldSettings settings{.seed = 10, .landmarks = 8, .scans = 200};
  settings.noise.control.sigma[1] = 0.01;
  const SmallWorld world = small_world(settings);
  FilterSetup setup = ekf_setup(8, Association::nearest);
  setup.belief.control.sigma[1] = 0.01;
  setup.association.gate = 25.0;  // nothing true is beyond it
  const auto nearest = make_ekf_slam(setup);
  setup.association.kind = Association::known;
  const auto known = make_ekf_slam(setup);
  const auto expected = estimates_of(*known, world), found = estimates_of(*nearest, world);
  for (std::size_t s = 0; s < expected.size(); ++s) {
    EXPECT_LT(boxminus(found[s].mean, expected[s].mean).norm(), 1e-12) << "scan " << s;
  }
}

TEST(EkfSlam, TwoDetectionsNeverShareALandmark) {
  const auto filter = make_ekf_slam(ekf_setup(1, Association::nearest));
  const StepContext context(1, 0, 0, Parallel::serial());
  const Detection alone{10.0, 0.3, 0};
  const std::vector<Detection> rivals{{10.2, 0.3, 0}, {10.1, 0.3, 0}};
  filter->start({});
  filter->update(context, Scan(&alone, 1));
  filter->update(context, rivals);
  EXPECT_EQ(filter->report().nis_dof, 2u);
  EXPECT_NEAR(filter->report().nis, 0.5, 1e-9);  // of the nearer: (0.1 m)^2 / (2 (0.1 m)^2)
}

TEST(EkfSlam, AMapThatRunsAwayFailsTheRun) {
  FilterSetup setup = ekf_setup(1, Association::nearest);
  setup.association.most_landmarks = 1;
  const auto filter = make_ekf_slam(setup);
  const StepContext context(1, 0, 0, Parallel::serial());
  const std::vector<Detection> scan{{10.0, 0.3, 0}, {20.0, -0.3, 1}};
  filter->start({});
  EXPECT_THROW(filter->update(context, scan), std::runtime_error);
}

TEST(EkfSlam, ReportsWhatItMatched) {
  const SmallWorld world = small_world({.seed = 11});
  const auto filter = make_ekf_slam(ekf_setup(20));
  double nis = 0.0;
  std::uint32_t dof = 0;
  drive_through(*filter, world, {}, [&](std::size_t s) {
    const ScanReport& report = filter->report();
    EXPECT_LE(report.nis_dof, 2 * world.drive.scan(s).size());
    EXPECT_EQ(report.numerical_faults, 0u);
    EXPECT_TRUE(s > 0 || report.nis_dof == 0);
    nis += report.nis;
    dof += report.nis_dof;
  });
  // A chi-square sum of so many degrees of freedom has the standard deviation sqrt(2 dof): five of
  // them.
  EXPECT_NEAR(nis, dof, 5.0 * std::sqrt(2.0 * dof));
}

TEST(EkfSlam, LikelihoodIsTheGaussianOfTheInnovation) {
  const auto filter = make_ekf_slam(ekf_setup(1));
  const StepContext context(1, 0, 0, Parallel::serial());
  const Detection first{10.0, 0.3, 0};
  const Detection second{10.1, 0.31, 0};
  filter->start({});
  filter->update(context, Scan(&first, 1));
  filter->update(context, Scan(&second, 1));
  // Known pose: the landmark's covariance seen from where it was placed is R, so S = 2 R.
  const Belief belief;
  const double d2 =
      std::pow(0.1 / belief.sigma_range, 2) / 2 + std::pow(0.01 / belief.sigma_bearing, 2) / 2;
  EXPECT_NEAR(filter->report().nis, d2, 1e-12);
  EXPECT_NEAR(filter->report().log_likelihood,
              -0.5 * d2 - std::log(2.0 * M_PI * 2.0 * belief.sigma_range * belief.sigma_bearing),
              1e-12);
}

TEST(EkfSlam, LeavesOutClutterAndLandmarksTooNearForABearing) {
  const auto filter = make_ekf_slam(ekf_setup(2));
  const StepContext context(1, 0, 0, Parallel::serial());
  const std::vector<Detection> scan{{0.0, 0.0, 0}, {5.0, 0.1, Detection::kClutter}};
  filter->start({});
  filter->update(context, scan);  // initialises a landmark where the vehicle stands
  filter->update(context, scan);
  EXPECT_EQ(filter->report().nis_dof, 0u);
  EXPECT_EQ(boxminus(filter->estimate().spread.mean, Pose{}).norm(), 0.0);
  std::vector<std::optional<LandmarkEstimate>> map(2);
  filter->map(map);
  EXPECT_TRUE(map[0].has_value());
  EXPECT_FALSE(map[1].has_value());
}

TEST(EkfSlam, CountsAnInnovationThatIsNotPositiveDefinite) {
  FilterSetup setup = ekf_setup(1);
  setup.belief.sigma_range = setup.belief.sigma_bearing = 0.0;
  const auto filter = make_ekf_slam(setup);
  const StepContext context(1, 0, 0, Parallel::serial());
  const Detection detection{10.0, 0.3, 0};
  filter->start({});
  filter->update(context, Scan(&detection, 1));
  filter->update(context, Scan(&detection, 1));
  EXPECT_EQ(filter->report().numerical_faults, 1u);
  EXPECT_EQ(filter->report().nis_dof, 0u);
}

TEST(JointBelief, CountsAnInnovationThatIsNotPositiveDefiniteInAnIteration) {
  FilterSetup setup = ekf_setup(1);
  setup.belief.sigma_range = 0.0;
  JointBelief belief(setup, Retraction::additive, 3);
  const Detection first{10.0, 0.3, 0}, absurd{1e200, 0.3, 0};  // its square is no number
  belief.start({});
  belief.update_with({}, Scan(&first, 1));
  belief.initialise_landmarks(Scan(&first, 1));
  MotionIncrement motion;
  motion.advance({3.0, 0.1}, 0.2, setup.belief);
  belief.update_with(motion, Scan(&absurd, 1));
  EXPECT_EQ(belief.outcome().faults, 1u);
  EXPECT_EQ(belief.used_detections().size(), 1u);  // used as it was linearised last
}

}  // namespace
}  // namespace montecarta::filters
