// SPDX-License-Identifier: BSD-3-Clause
#include "filters/association/pairing.hpp"

#include "filters/factory.hpp"
#include "filters/fastslam/nearest_association.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

const AssociationSettings kNearest{.kind = Association::nearest, .gate = 6.0, .new_gate = 25.0};

struct Candidate {
  double distance;
  double log_det = 0.0;
};

Pairing judged(std::initializer_list<Candidate> candidates) {
  NearestSearch search;
  std::uint32_t landmark = 0;
  for (const Candidate& c : candidates) {
    search.offer(landmark++, c.distance, c.distance + c.log_det, kNearest.gate);
  }
  return decide_pairing(search, kNearest);
}

TEST(Nearest, AnEmptyMapMakesALandmark) { EXPECT_EQ(judged({}).kind, PairingKind::fresh); }

TEST(Nearest, ChoosesTheNearestInsideTheGate) {
  const Pairing pairing = judged({{5.0}, {1.0}, {3.0}});
  EXPECT_EQ(pairing.kind, PairingKind::matched);
  EXPECT_EQ(pairing.landmark, 1u);
  EXPECT_EQ(pairing.cost, 1.0);
}

TEST(Nearest, ASureLandmarkBeatsANearerVagueOne) {
  // D^2 alone favours the most uncertain landmark; log det S makes up for that.
  EXPECT_EQ(judged({{1.0, 4.0}, {2.0, -4.0}}).landmark, 1u);
}

TEST(Nearest, TheGateAppliesToDistanceNotToCost) {
  EXPECT_EQ(judged({{5.9, 10.0}, {7.0, -100.0}}).landmark, 0u);
}

TEST(Nearest, BetweenTheGatesADetectionIsIgnored) {
  EXPECT_EQ(judged({{6.0}}).kind, PairingKind::ignored);
  EXPECT_EQ(judged({{25.0}, {300.0}}).kind, PairingKind::ignored);
}

TEST(Nearest, BeyondTheOuterGateOfAllItIsNew) {
  EXPECT_EQ(judged({{25.1}, {300.0}}).kind, PairingKind::fresh);
}

TEST(Nearest, OfEqualsTheFirstOfferedWins) { EXPECT_EQ(judged({{2.0}, {2.0}}).landmark, 0u); }

TEST(MutualExclusion, TheBetterOfTwoRivalsKeepsTheLandmark) {
  std::array<Pairing, 3> pairings{{{PairingKind::matched, 4, 2.0},
                                   {PairingKind::matched, 7, 9.0},
                                   {PairingKind::matched, 4, 1.0}}};
  exclude_rivals(pairings);
  EXPECT_EQ(pairings[0].kind, PairingKind::ignored);
  EXPECT_EQ(pairings[1].kind, PairingKind::matched);
  EXPECT_EQ(pairings[2].kind, PairingKind::matched);
}

TEST(MutualExclusion, OneOfThreeRivalsRemainsWhateverTheOrder) {
  std::array<double, 3> costs{1.0, 2.0, 3.0};
  do {
    std::array<Pairing, 3> pairings;
    for (std::size_t k = 0; k < 3; ++k) pairings[k] = {PairingKind::matched, 5, costs[k]};
    exclude_rivals(pairings);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(pairings[k].kind == PairingKind::matched, costs[k] == 1.0);
    }
  } while (std::next_permutation(costs.begin(), costs.end()));
}

TEST(MutualExclusion, OfEqualRivalsTheFirstWins) {
  std::array<Pairing, 2> pairings{{{PairingKind::matched, 0, 1.0}, {PairingKind::matched, 0, 1.0}}};
  exclude_rivals(pairings);
  EXPECT_EQ(pairings[0].kind, PairingKind::matched);
  EXPECT_EQ(pairings[1].kind, PairingKind::ignored);
}

TEST(MutualExclusion, NewAndIgnoredDetectionsAreNobodysRivals) {
  std::array<Pairing, 3> pairings{{{PairingKind::fresh, 0, 0.0},
                                   {PairingKind::ignored, 0, 0.0},
                                   {PairingKind::matched, 0, 5.0}}};
  exclude_rivals(pairings);
  EXPECT_EQ(pairings[0].kind, PairingKind::fresh);
  EXPECT_EQ(pairings[2].kind, PairingKind::matched);
}

TEST(NewDensity, IsTheGaussianAtTheGateWithTwiceTheSensorNoise) {
  Belief belief;
  belief.sigma_range = 0.3;
  belief.sigma_bearing = 0.04;
  const double det_2pi_S = std::pow(2.0 * M_PI, 2) * (2.0 * 0.3 * 0.3) * (2.0 * 0.04 * 0.04);
  const double expected = std::log(std::exp(-0.5 * 6.0) / std::sqrt(det_2pi_S));
  EXPECT_NEAR(log_new_density(kNearest, belief), expected, 1e-12);
  AssociationSettings shifted = kNearest;
  shifted.log_new_density_offset = -1.5;
  EXPECT_NEAR(log_new_density(shifted, belief), expected - 1.5, 1e-12);
}

TEST(NewDensity, HasTheDimensionOfADetection) {
  Belief belief;
  belief.sigma_range = 0.3;
  belief.sensor.kind = RangeSensor();
  const double expected = -0.5 * 6.0 - 0.5 * std::log(2.0 * M_PI * 2.0 * 0.3 * 0.3);
  EXPECT_NEAR(log_new_density(kNearest, belief), expected, 1e-12);
}

double total(const AssociationCounts& c) {
  return c.correct + c.wrong + c.new_again + c.missed + c.clutter;
}

TEST(AssociationCounts, EveryDecisionHasItsPlace) {
  constexpr std::int32_t kClutter = Detection::kClutter;
  const std::vector<std::int32_t> made_of{7, 4, kClutter};  // slot 2 is a phantom
  struct Case {
    std::int32_t identity;
    Pairing pairing;
    double AssociationCounts::*count;
  };
  const Case cases[] = {
      {4, {.kind = PairingKind::matched, .landmark = 1}, &AssociationCounts::correct},
      {4, {.kind = PairingKind::matched, .landmark = 0}, &AssociationCounts::wrong},
      {4, {.kind = PairingKind::matched, .landmark = 2}, &AssociationCounts::wrong},
      {5, {.kind = PairingKind::fresh}, &AssociationCounts::correct},
      {7, {.kind = PairingKind::fresh}, &AssociationCounts::new_again},
      {7, {.kind = PairingKind::ignored}, &AssociationCounts::missed},
      {5, {.kind = PairingKind::ignored}, &AssociationCounts::missed},
      {kClutter, {.kind = PairingKind::matched, .landmark = 2}, &AssociationCounts::clutter},
      {kClutter, {.kind = PairingKind::fresh}, &AssociationCounts::clutter},
      {kClutter, {.kind = PairingKind::ignored}, nullptr},
  };
  for (const Case& each : cases) {
    const Detection detection{10.0, 0.0, each.identity};
    const auto counts =
        association_counts(Scan(&detection, 1), std::span(&each.pairing, 1), made_of);
    EXPECT_EQ(total(counts), each.count == nullptr ? 0.0 : 1.0) << &each - cases;
    if (each.count == nullptr) continue;
    EXPECT_EQ(counts.*each.count, 1.0) << &each - cases;
  }
}

LandmarkGaussian<double> initialised_at(double x, double y) {
  return {.mean = {x, y}, .covariance = {0.01, 0.0, 0.01}};
}

const StepContext kContext(1, 0, 0, Parallel::serial());

/// One scan by particles that stand at x = 0 and at x = `second`, facing along x.
AssociationCounts look(NearestAssociation<double>& association, ParticleMaps<double>& maps,
                       const Weights<double>& weights, double second,
                       const std::vector<Detection>& scan) {
  std::vector<PoseGaussian<double>> poses(2);
  poses[1].mean.x = second;
  association.associate(kContext, scan, maps, poses);
  const AssociationCounts counts = association.counts(weights);
  for (const auto& fresh : association.new_landmarks(kContext, maps)) {
    const auto& values = fresh.detection.values;
    fresh.put(initialised_at(poses[fresh.block].mean.x + values[0] * std::cos(values[1]),
                             values[0] * std::sin(values[1])),
              maps.blocks_of(fresh.slot)[fresh.block]);
  }
  return counts;
}

TEST(AssociationCounts, AreMeansOverParticlesWhoseMemoryGoesWithTheirMaps) {
  const Belief belief{.sigma_range = 0.1, .sigma_bearing = 0.01};
  NearestAssociation<double> association(2, {.kind = Association::nearest}, belief);
  ParticleMaps<double> maps(2);
  Weights<double> weights(2);
  weights.multiply(1, std::log(3.0));  // weights 1/4 and 3/4
  weights.normalise(kContext);
  const std::vector<Detection> a{{10.0, 0.0, 0}}, b{{10.0, 0.0, 1}}, far_b{{13.0, 0.0, 1}};
  EXPECT_EQ(look(association, maps, weights, 0.0, a).correct, 1.0);  // new to both
  // Where the second particle believes to have gone on by 3 m, it sees another landmark; the first
  // takes it for the one it knows.
  const AssociationCounts second = look(association, maps, weights, 3.0, b);
  EXPECT_DOUBLE_EQ(second.wrong, 0.25);
  EXPECT_DOUBLE_EQ(second.correct, 0.75);
  const std::vector<std::uint32_t> parents{1, 1};
  maps.resample(kContext, parents);
  association.resample(kContext, parents);
  // Now both know both landmarks.
  const AssociationCounts third = look(association, maps, weights, 0.0, far_b);
  EXPECT_DOUBLE_EQ(third.correct, 1.0);
  EXPECT_DOUBLE_EQ(total(third), 1.0);
}

TEST(AssociationCounts, AddUpToTheDetectionsInEveryFilter) {
  SmallWorldSettings settings{.seed = 3, .landmarks = 60, .scans = 30};
  settings.noise.control.sigma[1] = 0.3;  // so that some go wrong
  const SmallWorld world = small_world(settings);
  for (const FilterKind& kind : filter_kinds()) {
    if (!kind.reports.map) continue;  // associates nothing
    for (const Association association : {Association::known, Association::nearest}) {
      const auto filter = make_filter(kind, settings, {{"particles", "24"}}, association);
      AssociationCounts sum;
      drive_through(*filter, world, {}, [&](std::size_t s) {
        const AssociationCounts& counts = filter->report().association;
        EXPECT_NEAR(total(counts), static_cast<double>(world.drive.scan(s).size()), 1e-9);
        add(counts, 1.0, sum);
      });
      const bool errs = sum.wrong + sum.new_again + sum.missed > 0.0;
      EXPECT_EQ(errs, association == Association::nearest) << kind.name;
      EXPECT_GT(sum.correct, 0.1 * total(sum)) << kind.name;
    }
  }
}

}  // namespace
}  // namespace montecarta::filters
