// SPDX-License-Identifier: BSD-3-Clause
#include "filters/association/nearest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

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
  return judge(search, kNearest);
}

TEST(Nearest, AnEmptyMapMakesALandmark) { EXPECT_EQ(judged({}).kind, PairingKind::fresh); }

TEST(Nearest, ChoosesTheNearestInsideTheGate) {
  const Pairing pairing = judged({{5.0}, {1.0}, {3.0}});
  EXPECT_EQ(pairing.kind, PairingKind::matched);
  EXPECT_EQ(pairing.landmark, 1u);
  EXPECT_EQ(pairing.cost, 1.0);
}

TEST(Nearest, ASureLandmarkBeatsANearerVagueOne) {
  // D^2 alone favours what knows least; log det S takes that advantage away.
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

}  // namespace
}  // namespace montecarta::filters
