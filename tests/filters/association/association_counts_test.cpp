// SPDX-License-Identifier: BSD-3-Clause
#include "filters/association/association_counts.hpp"

#include "filters/factory.hpp"
#include "filters/fastslam/nearest_association.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

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

/// One scan by particles that stand at x = 0 and at x = `second`, facing along x.
AssociationCounts look(NearestAssociation<double>& association, ParticleMaps<double>& maps,
                       const Weights<double>& weights, double second,
                       const std::vector<Detection>& scan) {
  std::vector<PoseGaussian<double>> poses(2);
  poses[1].mean.x = second;
  association.associate(StepContext(1, 0, 0, Parallel::serial()), scan, maps, poses);
  const AssociationCounts counts = association.counts(weights);
  for (const auto& fresh : association.new_landmarks(maps)) {
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
  weights.normalise();
  const std::vector<Detection> a{{10.0, 0.0, 0}}, b{{10.0, 0.0, 1}}, far_b{{13.0, 0.0, 1}};
  EXPECT_EQ(look(association, maps, weights, 0.0, a).correct, 1.0);  // new to both
  // Where the second particle believes to have gone on by 3 m, it sees another landmark; the first
  // takes it for the one it knows.
  const AssociationCounts second = look(association, maps, weights, 3.0, b);
  EXPECT_DOUBLE_EQ(second.wrong, 0.25);
  EXPECT_DOUBLE_EQ(second.correct, 0.75);
  const std::vector<std::uint32_t> parents{1, 1};
  maps.resample(parents);
  association.resample(parents);
  // Now both know both landmarks.
  const AssociationCounts third = look(association, maps, weights, 0.0, far_b);
  EXPECT_DOUBLE_EQ(third.correct, 1.0);
  EXPECT_DOUBLE_EQ(total(third), 1.0);
}

std::unique_ptr<SlamFilter> make_default(const FilterKind& kind, const SmallWorldSettings& settings,
                                         Association association) {
  std::map<std::string, std::string, std::less<>> values;
  for (const Option& option : kind.options) values[option.key] = *option.fallback;
  if (kind.has_particles) values["particles"] = "24";
  return kind.make({.belief = settings.noise,
                    .association = {.kind = association},
                    .options = FilterOptions(values),
                    .landmarks = settings.landmarks});
}

TEST(AssociationCounts, AddUpToTheDetectionsInEveryFilter) {
  SmallWorldSettings settings{.seed = 3, .landmarks = 60, .scans = 30};
  settings.noise.control.sigma[1] = 0.3;  // so that some go wrong
  const SmallWorld world = small_world(settings);
  for (const FilterKind& kind : filter_kinds()) {
    if (!kind.has_map) continue;  // associates nothing
    for (const Association association : {Association::known, Association::nearest}) {
      const auto filter = make_default(kind, settings, association);
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
