// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/pose_evolution.hpp"

#include "filters/fastslam/concepts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr std::size_t kMembers = 10;
constexpr std::size_t kLanes = Lanes::kSize;

double name_of(std::size_t member, std::size_t lane, std::size_t field) {
  return static_cast<double>(100 * member + 10 * lane + field);
}

/// Two numbers for every member and lane.
std::vector<std::array<Lanes, 2>> candidates() {
  std::vector<std::array<Lanes, 2>> all(kMembers);
  for (std::size_t member = 0; member < kMembers; ++member)
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      for (std::size_t field = 0; field < 2; ++field)
        set(all[member][field], lane, name_of(member, lane, field));
  return all;
}

TEST(PackedCandidates, JudgeEveryLivingOneOnceByItsOwnParticle) {
  const auto all = candidates();
  Lanes particles(0.0);
  for (std::size_t lane = 0; lane < kLanes; ++lane) set(particles, lane, 10.0 * double(lane));
  for (std::size_t used_lanes = 1; used_lanes <= kLanes; ++used_lanes) {
    const PackedCandidates<Lanes> packed(used_lanes, kMembers);
    std::vector<Lanes> back(kMembers, Lanes(-1.0));
    for (std::size_t q = 0; q < packed.blocks(); ++q) {
      const auto [number, next] = packed.pack(std::span(all), q);
      const Lanes own = packed.pattern_of(particles, q % packed.patterns());
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        EXPECT_EQ(static_cast<int>(number.get(lane)) % 100, own.get(lane))
            << used_lanes << ' ' << q;
        EXPECT_EQ(next.get(lane), number.get(lane) + 1.0);
      }
      packed.unpack(number, q, back);
    }
    for (std::size_t member = 0; member < kMembers; ++member)
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        EXPECT_EQ(back[member].get(lane), lane < used_lanes ? name_of(member, lane, 0) : -1.0);
  }
}

TEST(PackedCandidates, TakeAsFewRegistersAsTheyFill) {
  EXPECT_EQ((PackedCandidates<Lanes>(3, kMembers).blocks()), 4U);  // 30 candidates
  EXPECT_EQ((PackedCandidates<Lanes>(kLanes, kMembers).blocks()), kMembers);
  EXPECT_EQ((PackedCandidates<double>(1, kMembers).blocks()), kMembers);
  EXPECT_EQ((PackedCandidates<double>(1, kMembers).patterns()), 1U);
}

/// The matches of the particles of one block: each has a landmark and a detection of its own, and
/// every other particle knows the second landmark.
struct Matches {
  std::size_t matches() const { return 2; }
  auto match(std::size_t /*b*/, std::size_t k) const {
    LandmarkGaussian<Lanes> landmark{{Lanes(0.0), Lanes(0.0)},
                                     {Lanes(0.2), Lanes(0.05), Lanes(0.1)}};
    Lanes known(1.0);
    for (std::size_t lane = 0; lane < Lanes::kSize; ++lane) {
      set(landmark.mean.x, lane, 10.0 + 0.1 * static_cast<double>(lane + k));
      set(landmark.mean.y, lane, 5.0 - 8.0 * static_cast<double>(k));
      if (k == 1) set(known, lane, static_cast<double>(lane % 2));
    }
    const auto mask = known > Lanes(0.5);
    return Match<Lanes, LandmarkGaussian<Lanes>, decltype(known > Lanes(0.5))>{
        landmark, {Lanes(11.0), Lanes(0.4 - 0.7 * double(k))}, mask};
  }
};

std::array<Lanes, 3> most_probable(std::size_t particles) {
  const Symmetric3<Lanes> P{Lanes(0.3), Lanes(0.0),  Lanes(0.2),
                            Lanes(0.0), Lanes(0.01), Lanes(0.02)};
  PoseGaussian<Lanes> predicted{{Lanes(0.0), Lanes(0.0), Lanes(0.1)}, P};
  for (std::size_t lane = 0; lane < Lanes::kSize; ++lane)
    set(predicted.mean.y, lane, 0.05 * static_cast<double>(lane));
  OwnEvolution<Lanes> own(particles, 10);
  return own
      .most_probable(Matches(), 0, predicted, predicted, {.first = 0.01, .second = 0.001}, 3.0,
                     EvolutionSettings(), {7, 0, 3, 0, Draw::evolution})
      .offset;
}

// Packed with few others or evolving with many: a particle finds the same, to the last bit.
TEST(OwnEvolution, DoesNotDependOnHowManyParticlesShareABlock) {
  const std::array<Lanes, 3> all = most_probable(Lanes::kSize);
  EXPECT_NE(get(all[0], 0), get(all[0], 1));
  for (std::size_t particles = 1; particles < Lanes::kSize; ++particles) {
    const std::array<Lanes, 3> few = most_probable(particles);
    for (std::size_t lane = 0; lane < particles; ++lane)
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_EQ(get(few[j], lane), get(all[j], lane)) << particles << ' ' << lane;
  }
}

}  // namespace
}  // namespace montecarta::filters
