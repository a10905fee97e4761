// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/map_learning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr SensorNoise kNoise{0.01, 0.0004};
const StepContext kContext(1, 0, 0, Parallel::serial());
const Point kTruth{8.0, 6.0};

/// Weighted poses around the origin, and the detection of the landmark from one of them.
template <class Real>
struct Cloud {
  std::vector<BasicPose<Real>> poses;
  Weights<Real> weights;
  RangeBearing<double> seen;

  explicit Cloud(double width, std::size_t n = 13, std::uint32_t seed = 0)
      : poses(blocks_for<Real>(n)), weights(n) {
    RngStream draw({3, 0, 0, seed, Draw::test});
    const auto observation = predicted_observation(Pose{}, kTruth);
    seen = {observation.range + 0.1 * draw.normal(), observation.bearing + 0.02 * draw.normal()};
    for (std::size_t i = 0; i < poses.size() * kLanesOf<Real>; ++i) {
      BasicPose<Real>& pose = poses[i / kLanesOf<Real>];
      set(pose.x, i % kLanesOf<Real>, width * draw.normal());
      set(pose.y, i % kLanesOf<Real>, width * draw.normal());
      set(pose.heading, i % kLanesOf<Real>, 0.1 * width * draw.normal());
    }
    for (std::size_t b = 0; b < poses.size(); ++b) {
      Real log_weight(0.0);
      for (std::size_t lane = 0; lane < kLanesOf<Real>; ++lane)
        set(log_weight, lane, 0.1 * static_cast<double>(b * kLanesOf<Real> + lane));
      weights.multiply(b, log_weight);
    }
    weights.normalise(kContext);
  }
  SharedLandmark learnt(const MapSettings& settings, SharedLandmark landmark) const {
    EvolutionReport report;
    return learnt(settings, landmark, report);
  }
  SharedLandmark learnt(const MapSettings& settings, SharedLandmark landmark,
                        EvolutionReport& report) const {
    MapLearning<Real> learning(settings, kNoise);
    learning.learn(kContext, 4, 0.3, poses, weights, seen, landmark, report);
    return landmark;
  }
};

double distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y); }

const SharedLandmark kBefore{{8.1, 5.8}, {80.0, 10.0, 60.0}};

TEST(MapLearning, GaussNewtonAndEvolutionFindTheSamePlace) {
  const EvolutionSettings patient{.generations = 200, .tolerance = 1e-12};
  for (const MapObjective objective :
       {MapObjective::likelihood, MapObjective::squares, MapObjective::squares_as_printed}) {
    for (const MapMode mode : {MapMode::recursive, MapMode::onestep_converged}) {
      const Cloud<Lanes> cloud(0.05);
      const SharedLandmark newton = cloud.learnt({.mode = mode, .objective = objective}, kBefore);
      const SharedLandmark evolved = cloud.learnt(
          {.mode = mode, .solver = MapSolver::de, .objective = objective, .evolution = patient},
          kBefore);
      EXPECT_LT(distance(newton.mean, evolved.mean), 1e-4);
      EXPECT_NEAR(newton.information.xx, evolved.information.xx, 1e-2);
    }
  }
}

// EQUATIONS (9.3), computed again from (14.2) for one exact pose.
TEST(MapLearning, ReportsGainAndDisplacementOfItsEvolution) {
  const Cloud<double> cloud(0.0, 1);
  EvolutionReport report;
  const SharedLandmark after = cloud.learnt({.solver = MapSolver::de}, kBefore, report);
  const auto cost = [&](const Point& place) {
    const auto predicted = predicted_observation(Pose{}, place);
    const double r = cloud.seen.range - predicted.range;
    const double b = cloud.seen.bearing - predicted.bearing;
    const double x = place.x - kBefore.mean.x, y = place.y - kBefore.mean.y;
    const auto& L = kBefore.information;
    return std::pair(r * r / kNoise.first + b * b / kNoise.second,
                     L.xx * x * x + 2.0 * L.xy * x * y + L.yy * y * y);
  };
  const auto [fit, squared_way] = cost(after.mean);
  EXPECT_NEAR(report.values()[2], 0.5 * (cost(kBefore.mean).first - fit - squared_way), 1e-9);
  EXPECT_NEAR(report.values()[3], std::sqrt(squared_way), 1e-12);
  EXPECT_GT(report.values()[3], 0.1);
}

// From one exact pose the recursive map is the information filter: it averages.
TEST(MapLearning, RecursiveMapsAverageWhatTheySaw) {
  SharedLandmark landmark = kBefore;
  double before = 1e9;
  for (std::uint32_t scan = 0; scan < 400; ++scan) {
    const Cloud<Lanes> cloud(0.0, 13, scan);
    landmark = cloud.learnt({}, landmark);
    EXPECT_LT(landmark.covariance().xx, before);
    before = landmark.covariance().xx;
  }
  // sigma of one observation is about 0.1 m and 0.2 m; of 400, a twentieth: five of those
  EXPECT_LT(distance(landmark.mean, kTruth), 5.0 * 0.22 / 20.0);
  EXPECT_LT(landmark.covariance().xx, 0.04 / 400.0 * 1.5);
}

// EQUATIONS 14: the principle that (25) attributes to Bellman forgets all scans but the last.
TEST(MapLearning, OneStepMapsForgetWhateverWasBefore) {
  const Cloud<Lanes> cloud(0.0);
  const MapSettings settings{.mode = MapMode::onestep_converged};
  const SharedLandmark a = cloud.learnt(settings, kBefore);
  const SharedLandmark b = cloud.learnt(settings, {{7.8, 6.2}, {1e6, 0.0, 1e6}});
  const Point seen = linearised_place(Pose{}, cloud.seen).point;
  EXPECT_LT(distance(a.mean, seen), 1e-8);
  EXPECT_LT(distance(b.mean, seen), 1e-8);
  EXPECT_NEAR(a.information.xx, b.information.xx, 1e-6);
}

TEST(MapLearning, TheThresholdLeavesALandmarkWhereItExplainsTheScan) {
  const Cloud<Lanes> cloud(0.0);
  for (const MapSolver solver : {MapSolver::gauss_newton, MapSolver::de}) {
    MapSettings settings{.mode = MapMode::onestep_threshold, .solver = solver};
    settings.threshold = 1e3;
    EXPECT_EQ(distance(cloud.learnt(settings, kBefore).mean, kBefore.mean), 0.0);
    settings.threshold = 0.01;
    EXPECT_GT(distance(cloud.learnt(settings, kBefore).mean, kBefore.mean), 0.01);
  }
}

// Havangi (29) forgets the weights: a particle of no weight pulls as much as one of all.
TEST(MapLearning, AsPrintedTheWeightsMakeNoDifference) {
  Cloud<double> cloud(0.0, 2);
  cloud.poses[1].x = 1.0;
  cloud.weights.make_equal();
  cloud.weights.multiply(1, -50.0);
  cloud.weights.normalise(kContext);
  const Point of_heavy = linearised_place(cloud.poses[0], cloud.seen).point;
  MapSettings settings{.mode = MapMode::onestep_converged, .objective = MapObjective::squares};
  EXPECT_LT(distance(cloud.learnt(settings, kBefore).mean, of_heavy), 1e-6);
  settings.objective = MapObjective::squares_as_printed;
  EXPECT_NEAR(distance(cloud.learnt(settings, kBefore).mean, of_heavy), 0.5, 0.1);
}

TEST(MapLearning, ALandmarkIsInitialisedWhereTheWeightedParticlesSeeIt) {
  const Cloud<Lanes> cloud(0.05);
  MapLearning<Lanes> learning({}, kNoise);
  const SharedLandmark initialised =
      learning.initialised(kContext, cloud.poses, cloud.weights, cloud.seen);
  Point mean;
  for (std::size_t i = 0; i < 13; ++i) {
    const Pose pose = pose_of_particle<Lanes>([&](std::size_t b) { return cloud.poses[b]; }, i);
    const Point place = linearised_place(pose, cloud.seen).point;
    mean.x += cloud.weights.linear_scalars()[i] * place.x;
    mean.y += cloud.weights.linear_scalars()[i] * place.y;
  }
  EXPECT_LT(distance(initialised.mean, mean), 1e-12);
  const Symmetric2<double> P = initialised.covariance();
  const double range = cloud.seen.range;
  EXPECT_NEAR(P.xx * P.yy - P.xy * P.xy, 0.01 * 0.0004 * range * range, 1e-9);
}

}  // namespace
}  // namespace montecarta::filters
