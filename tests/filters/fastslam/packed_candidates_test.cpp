// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/packed_candidates.hpp"

#include <gtest/gtest.h>

#include <array>
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

}  // namespace
}  // namespace montecarta::filters
