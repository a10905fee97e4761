// SPDX-License-Identifier: BSD-3-Clause
// Joint filters equal those of their papers, written down with full matrices: plain filters, and a
// robocentric one that is for tests alone.
#include "filters/joint/joint_filter.hpp"
#include "tests/filters/reference/robocentric_ekf_slam.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace montecarta::filters {
namespace {

const Pose kStart{4.0, -3.0, 0.5};

/// The estimates of a literal filter after every scan, and of landmarks {identity} in the end.
struct Said {
  std::vector<PoseMoments> poses;
  std::vector<std::optional<LandmarkEstimate>> map;  ///< empty if it is not in the map's frame
};

/// The robocentric filter behind the signature of a SlamFilter.
struct Robocentric {
  reference::RobocentricEkfSlam filter;
  void start(const Pose& pose) { filter.start(pose); }
  void predict(const StepContext&, const Control& control, double duration) {
    filter.predict(control, duration);
  }
  void update(const StepContext&, Scan scan) { filter.update(scan); }
};

Said robocentric_filter(const FilterKind& /*kind*/, const SmallWorldSettings& settings,
                        const SmallWorld& world) {
  Said said;
  Robocentric literal{reference::RobocentricEkfSlam(settings.noise)};
  drive_through(literal, world, kStart,
                [&](std::size_t) { said.poses.push_back(literal.filter.moments()); });
  return said;
}

Said plain_filter(const FilterKind& kind, const SmallWorldSettings& settings,
                  const SmallWorld& world) {
  const auto plain = make_filter(
      *std::ranges::find(filter_kinds(), "plain_" + kind.name, &FilterKind::name), settings);
  Said said{.poses = estimates_of(*plain, world, kStart),
            .map = std::vector<std::optional<LandmarkEstimate>>(settings.landmarks)};
  plain->map(said.map);
  return said;
}

struct Case {
  FilterKind kind;
  Said (*literal)(const FilterKind&, const SmallWorldSettings&, const SmallWorld&) = plain_filter;
  SmallWorldSettings settings = {.seed = 5, .landmarks = 21, .scans = 250};
  double least = 15;  ///< landmarks in the end
};

/// The largest noise of the papers (Ankishan et al., Simulation I) for two laps, in which the
/// covariance loses most to rounding.
Case in_large_noise(Case one) {
  one.settings = {.seed = 41, .scans = 570};
  one.settings.noise = {.control = {.sigma = {1.0, 10.0 * kPi / 180.0}},
                        .sigma_range = 1.2,
                        .sigma_bearing = 12.0 * kPi / 180.0};
  return one;
}
/// A map of which most is compressed: one lap and a half, a twentieth of it in view.
Case in_large_map(Case one) {
  one.settings = {.seed = 41, .landmarks = 300, .scans = 430, .max_range = 11.0};
  one.least = 190;
  return one;
}
Case robocentric(std::size_t landmarks, std::size_t scans, double least) {
  Case one{robocentric_ekf_slam_kind(),
           robocentric_filter,
           {.seed = 5, .landmarks = landmarks, .scans = scans},
           least};
  one.settings.noise.sigma_bearing = 0.05;
  return one;
}

/// The covariance of the pose and of all landmarks that are in the map.
void expect_positive_definite(const SlamFilter& filter, std::size_t landmarks) {
  const auto joint = filter.joint(landmarks);
  if (!joint) return;
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < joint->mean.size(); ++i) {
    if (!std::isnan(joint->mean(i))) known.push_back(i);
  }
  const Eigen::MatrixXd P = joint->covariance(known, known);
  const Eigen::VectorXd scale = P.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlations = scale.asDiagonal() * P * scale.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(correlations);
  EXPECT_EQ(factor.info(), Eigen::Success);
  EXPECT_GT(factor.matrixLLT().diagonal().minCoeff(), 1e-3);
}

class AsPublished : public testing::TestWithParam<Case> {};

TEST_P(AsPublished, SlowEqualsTheLiteralFilter) {
  const auto& [kind, literal, settings, least] = GetParam();
  const SmallWorld world = small_world(settings);
  const Said expected = literal(kind, settings, world);
  const auto filter = make_filter(kind, settings);
  drive_through(*filter, world, kStart, [&](std::size_t s) {
    const PoseMoments& pose = filter->estimate().spread;
    EXPECT_LT(boxminus(pose.mean, expected.poses[s].mean).norm(), 1e-9) << "scan " << s;
    EXPECT_LT((pose.covariance - expected.poses[s].covariance).norm(), 1e-9) << "scan " << s;
  });
  EXPECT_GE(filter->report().map_size, least);
  EXPECT_EQ(filter->report().numerical_faults, 0U);
  expect_positive_definite(*filter, settings.landmarks);
  if (expected.map.empty()) return;
  std::vector<std::optional<LandmarkEstimate>> map(settings.landmarks);
  filter->map(map);
  for (std::size_t k = 0; k < map.size(); ++k) {
    ASSERT_EQ(map[k].has_value(), expected.map[k].has_value()) << "landmark " << k;
    if (!map[k]) continue;
    EXPECT_EQ(map[k]->covariance, map[k]->covariance.transpose());
    EXPECT_LT((map[k]->mean - expected.map[k]->mean).norm(), 1e-9);
    EXPECT_LT((map[k]->covariance - expected.map[k]->covariance).norm(), 1e-9);
  }
}

const Case kEkf{ekf_slam_kind()}, kRiekf{riekf_slam_kind()}, kFej{fej_ekf_slam_kind()},
    kOc{oc_ekf_slam_kind()};

INSTANTIATE_TEST_SUITE_P(All, AsPublished,
                         testing::Values(kEkf, in_large_noise(kEkf), in_large_map(kEkf), kRiekf,
                                         in_large_noise(kRiekf), in_large_map(kRiekf), kFej,
                                         in_large_map(kFej), kOc, in_large_map(kOc),
                                         robocentric(21, 250, 15), robocentric(300, 50, 101)),
                         [](const auto& instance) {
                           return instance.param.kind.name + "_" +
                                  std::to_string(instance.param.settings.landmarks);
                         });

}  // namespace
}  // namespace montecarta::filters
