// SPDX-License-Identifier: BSD-3-Clause
// Joint filters equal those of their papers, written down with full matrices.
#include "filters/joint/joint_filter.hpp"
#include "filters/plain/ekf_slam.hpp"
#include "tests/filters/reference/ekf_slams.hpp"
#include "tests/filters/reference/invariant_ekf_slam.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace montecarta::filters {
namespace {

const Pose kStart{4.0, -3.0, 0.5};

/// The estimates of a literal filter after every scan, and of landmarks {identity} in the end.
struct Said {
  std::vector<PoseMoments> poses;
  std::vector<std::optional<LandmarkEstimate>> map;
};

/// A literal filter behind the signature of a SlamFilter.
template <class Filter>
struct Literal {
  Filter filter;
  void start(const Pose& pose) { filter.start(pose); }
  void predict(const StepContext&, const Control& control, double duration) {
    filter.predict(control, duration);
  }
  void update(const StepContext&, Scan scan) { filter.update(scan); }
};

std::optional<LandmarkEstimate> landmark_of(const reference::FullGaussian& filter,
                                            std::int32_t identity) {
  const Eigen::Index row = filter.row_of(identity);
  if (row < 0) return std::nullopt;
  return LandmarkEstimate{filter.mean.segment<2>(row), filter.covariance.block<2, 2>(row, row)};
}
std::optional<LandmarkEstimate> landmark_of(const reference::InvariantEkfSlam& filter,
                                            std::int32_t identity) {
  const std::size_t point = filter.point_of(identity);
  if (point == 0) return std::nullopt;
  const Eigen::Index row = reference::InvariantEkfSlam::row(point);
  return LandmarkEstimate{filter.points[point], filter.covariance().block<2, 2>(row, row)};
}

template <class Filter>
Said said_by(Filter filter, const SmallWorld& world) {
  Said said;
  Literal<Filter> literal{std::move(filter)};
  drive_through(literal, world, kStart,
                [&](std::size_t) { said.poses.push_back(literal.filter.moments()); });
  for (std::size_t k = 0; k < world.itinerary.landmarks.size(); ++k)
    said.map.push_back(landmark_of(literal.filter, static_cast<std::int32_t>(k)));
  return said;
}

Said plain_ekf_slam(const SmallWorld& world, const Belief& belief) {
  Said said;
  plain::EkfSlam plain({.belief = belief,
                        .association = {},
                        .options = FilterOptions({}),
                        .landmarks = world.itinerary.landmarks.size()});
  drive_through(plain, world, kStart,
                [&](std::size_t) { said.poses.push_back(plain.estimate().spread); });
  said.map.resize(world.itinerary.landmarks.size());
  plain.map(said.map);
  return said;
}

struct Case {
  FilterKind kind;
  std::function<Said(const SmallWorld&, const Belief&)> literal;
  bool is_in_map = true;  ///< the literal filter's landmarks
  SmallWorldSettings settings = {.seed = 5, .landmarks = 21, .scans = 250};
  double least = 15;  ///< landmarks in the end
};

Case fej(const FilterKind& kind) {
  return {kind, [constrained = kind.name == "oc_ekf_slam"](const auto& world, const auto& belief) {
            return said_by(reference::FejEkfSlam(belief, constrained), world);
          }};
}
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
           [](const auto& world, const auto& belief) {
             return said_by(reference::RobocentricEkfSlam(belief), world);
           },
           false,
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
  const auto& [kind, literal, is_in_map, settings, least] = GetParam();
  const SmallWorld world = small_world(settings);
  const Said expected = literal(world, settings.noise);
  const auto filter = kind.make({.belief = settings.noise,
                                 .association = {},
                                 .options = default_options(kind),
                                 .landmarks = settings.landmarks});
  drive_through(*filter, world, kStart, [&](std::size_t s) {
    const PoseMoments& pose = filter->estimate().spread;
    EXPECT_LT(boxminus(pose.mean, expected.poses[s].mean).norm(), 1e-9) << "scan " << s;
    EXPECT_LT((pose.covariance - expected.poses[s].covariance).norm(), 1e-9) << "scan " << s;
  });
  EXPECT_GE(filter->report().map_size, least);
  EXPECT_EQ(filter->report().numerical_faults, 0U);
  expect_positive_definite(*filter, settings.landmarks);
  if (!is_in_map) return;
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

Case ekf() { return {ekf_slam_kind(), plain_ekf_slam}; }
Case riekf() {
  return {riekf_slam_kind(), [](const auto& world, const auto& belief) {
            return said_by(reference::InvariantEkfSlam(belief), world);
          }};
}

INSTANTIATE_TEST_SUITE_P(All, AsPublished,
                         testing::Values(ekf(), in_large_noise(ekf()), in_large_map(ekf()), riekf(),
                                         in_large_noise(riekf()), fej(fej_ekf_slam_kind()),
                                         fej(oc_ekf_slam_kind()), robocentric(21, 250, 15),
                                         robocentric(300, 50, 101)),
                         [](const auto& instance) {
                           return instance.param.kind.name + "_" +
                                  std::to_string(instance.param.settings.landmarks);
                         });

}  // namespace
}  // namespace montecarta::filters
