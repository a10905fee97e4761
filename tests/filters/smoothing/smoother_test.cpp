// SPDX-License-Identifier: BSD-3-Clause
#include "filters/smoothing/smoother.hpp"

#include "filters/joint/joint_filters.hpp"
#include "tests/filters/default_options.hpp"
#include "tests/filters/fine_noise.hpp"
#include "tests/filters/same_runs.hpp"
#include "tests/filters/smoothing/small_graph.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace montecarta::filters {
namespace {

using Others = std::map<std::string, std::string, std::less<>>;

std::unique_ptr<SlamFilter> make(const FilterKind& kind, const SmallWorldSettings& settings,
                                 const Others& others = {}) {
  return kind.make({.belief = settings.noise,
                    .association = {},
                    .options = default_options(kind, others),
                    .landmarks = settings.landmarks});
}

TEST(Smoother, IsTheIteratedInvariantFilterWhereItNeverLinearisesAgain) {
  const SmallWorldSettings settings{.seed = 44, .scans = 120};
  const SmallWorld world = small_world(settings);
  const auto smoother =
      make(smoother_kind(), settings, {{"relinearise", "1e9"}, {"moments", "map"}});
  const auto filter =
      make(riekf_slam_kind(), settings, {{"iterations", "5"}, {"motion", "quadrature"}});
  expect_same_run(*smoother, *filter, world, 1e-12);
}

TEST(Smoother, LinearisingAtEveryScanIsTheBatchEstimate) {
  const SmallWorldSettings settings{.seed = 45, .scans = 80};
  const SmallWorld world = small_world(settings);
  const auto smoother = make(smoother_kind(), settings, {{"relinearise", "0"}, {"moments", "map"}});
  drive_through(*smoother, world, {}, [](std::size_t) {});
  SmallGraph batch = small_graph(world, settings.noise, Beginning::truth);
  GaussNewton solver(SensorNoise::of(settings.noise));
  ASSERT_TRUE(solver.solve(batch.graph, 1e-12, batch.estimate));
  // Settled is a tenth of a standard deviation before the last step, which leaves far less.
  const PoseMoments now = smoother->estimate().spread;
  EXPECT_LT(boxminus(now.mean, batch.estimate.poses.back()).norm(), 1e-4);
  std::vector<std::optional<LandmarkEstimate>> map(settings.landmarks);
  smoother->map(map);
  for (std::size_t l = 0; l < batch.identities.size(); ++l) {
    const auto& landmark = map[static_cast<std::size_t>(batch.identities[l])];
    ASSERT_TRUE(landmark);
    EXPECT_LT((landmark->mean - to_vector(batch.estimate.landmarks[l])).norm(), 1e-4);
  }
}

// The joint is of a solution of its own, whatever the filter linearised before.
TEST(Smoother, JointDoesNotDependOnWhenAllWasLinearisedAgain) {
  const SmallWorldSettings settings{.seed = 47, .scans = 120};
  const SmallWorld world = small_world(settings);
  const auto always = make(smoother_kind(), settings, {{"relinearise", "0"}});
  const auto never = make(smoother_kind(), settings, {{"relinearise", "1e9"}});
  drive_through(*always, world, {}, [](std::size_t) {});
  drive_through(*never, world, {}, [](std::size_t) {});
  const JointEstimate a = *always->joint(settings.landmarks);
  const JointEstimate b = *never->joint(settings.landmarks);
  EXPECT_EQ(b.covariance.topLeftCorner(3, 3), b.covariance.topLeftCorner(3, 3).transpose());
  const PoseMoments carried = never->estimate().spread;
  EXPECT_GT((b.mean.head<2>() - place_of(carried.mean)).norm(), 1e-4) << "was not solved anew";
  for (Eigen::Index i = 0; i < a.mean.size(); ++i) {
    const double sigma = std::sqrt(a.covariance(i, i));
    EXPECT_EQ(std::isnan(a.mean(i)), std::isnan(b.mean(i)));
    if (std::isnan(a.mean(i))) continue;
    EXPECT_LT(std::abs(a.mean(i) - b.mean(i)), 0.02 * sigma);
  }
}

// The information about a range measured without noise is infinite.
TEST(Smoother, JointOfTheCarriedBeliefInsteadOfASolutionIsANumericalFault) {
  SmallWorldSettings settings{.seed = 48, .scans = 3};
  const SmallWorld world = small_world(settings);
  settings.noise.sigma_range = 1e-200;
  const auto pushed = make(smoother_kind(), settings);
  const auto carried = make(smoother_kind(), settings, {{"moments", "map"}});
  drive_through(*pushed, world, {}, [](std::size_t) {});
  drive_through(*carried, world, {}, [](std::size_t) {});
  const JointEstimate held = *carried->joint(settings.landmarks);
  EXPECT_EQ(held.numerical_faults, 0u);
  EXPECT_TRUE(held.mean.head(3).allFinite());
  EXPECT_EQ(pushed->joint(settings.landmarks)->numerical_faults, 1u);
}

// With noise so fine that all models are linear it is the Kalman filter, by way of all poses.
TEST(Smoother, IsTheKalmanFilterOnALinearModel) {
  SmallWorldSettings settings{.seed = 46, .scans = 60};
  settings.noise = fine();
  const SmallWorld world = small_world(settings);
  const auto smoother = make(smoother_kind(), settings, {{"relinearise", "0"}});
  const auto kalman = make(ekf_slam_kind(), settings);
  std::vector<PoseMoments> expected;
  drive_through(*kalman, world, {},
                [&](std::size_t) { expected.push_back(kalman->estimate().spread); });
  drive_through(*smoother, world, {}, [&](std::size_t scan) {
    const PoseMoments now = smoother->estimate().spread;
    const Eigen::LLT<Eigen::Matrix3d> L(expected[scan].covariance);
    const Eigen::Vector3d way = boxminus(now.mean, expected[scan].mean);
    EXPECT_LT(L.matrixL().solve(way).norm(), 0.02) << "scan " << scan;
    EXPECT_TRUE(now.covariance.isApprox(expected[scan].covariance, 1e-3)) << "scan " << scan;
  });
}

}  // namespace
}  // namespace montecarta::filters
