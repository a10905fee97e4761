// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/diversity.hpp"

#include "engine/errors.hpp"
#include "engine/random/stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <set>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

std::vector<double> scan_times(std::size_t scans) {
  std::vector<double> times(scans);
  std::iota(times.begin(), times.end(), 1.0);
  return times;
}

// Four particles: resampled before scan 2 (three parents) and before scan 4 (two parents).
TEST(Diversity, CountsAHandMadeGenealogy) {
  const std::vector<std::uint32_t> ancestor = {0, 1, 2, 3,   //
                                               0, 1, 2, 3,   //
                                               0, 0, 1, 3,   // 2 died
                                               0, 1, 2, 3,   //
                                               1, 1, 2, 2};  // 0 and 3 died
  DiversityCounter counter;
  const Diversity& found = counter.count(ancestor, 4, scan_times(5));
  EXPECT_THAT(found.last_resampling, ElementsAre(4, 4, 3, 3, 2));
  EXPECT_THAT(found.root, ElementsAre(4, 4, 3, 3, 2));
  EXPECT_THAT(found.lag, ElementsAre(4, 4, 3, 3, 2));
}

TEST(Diversity, ForgetsResamplingsOlderThanTheLag) {
  std::vector<std::uint32_t> ancestor;
  for (int s = 0; s < 30; ++s) {
    const std::uint32_t first = s == 3 ? 1 : 0;
    ancestor.insert(ancestor.end(), {first, 1});
  }
  DiversityCounter counter;
  const Diversity& found = counter.count(ancestor, 2, scan_times(30));
  EXPECT_EQ(found.lag[2], 2u);
  EXPECT_EQ(found.lag[3], 1u);
  EXPECT_EQ(found.lag[12], 1u);  // 13 s: looks back to 3 s, before the resampling at 4 s
  EXPECT_EQ(found.lag[13], 2u);  // 14 s: looks back to 4 s, after it
  EXPECT_EQ(found.root[29], 1u);
  EXPECT_EQ(found.last_resampling[29], 1u);
}

/// Distinct ancestors, before scan `first`, of the particles of scan s, one hop at a time.
std::size_t walk_back(const std::vector<std::uint32_t>& ancestor, std::size_t particles,
                      std::size_t first, std::size_t s) {
  std::set<std::uint32_t> found;
  for (std::uint32_t i = 0; i < particles; ++i) {
    std::uint32_t index = i;
    for (std::size_t hop = s + 1; hop > first; --hop) {
      index = ancestor[(hop - 1) * particles + index];
    }
    found.insert(index);
  }
  return found.size();
}

std::vector<std::uint32_t> random_genealogy(std::size_t particles, std::size_t scans,
                                            RngStream& draw) {
  std::vector<std::uint32_t> ancestor;
  for (std::size_t s = 0; s < scans; ++s) {
    const bool resampled = draw.uniform() < 0.3;
    for (std::uint32_t i = 0; i < particles; ++i) {
      ancestor.push_back(resampled ? draw.below(static_cast<std::uint32_t>(particles)) : i);
    }
  }
  return ancestor;
}

TEST(Diversity, EqualsWalkingBackEveryParticle) {
  DiversityCounter counter;
  for (std::uint64_t run = 0; run < 20; ++run) {
    RngStream draw({3, run, 0, 0, Draw::test});
    const std::size_t particles = 5 + 3 * run, scans = 40;
    const auto ancestor = random_genealogy(particles, scans, draw);
    const Diversity& found = counter.count(ancestor, particles, scan_times(scans));
    for (std::size_t s = 0; s < scans; ++s) {
      EXPECT_EQ(found.root[s], walk_back(ancestor, particles, 0, s)) << run << " " << s;
      const std::size_t first = s < 10 ? 0 : s - 9;
      EXPECT_EQ(found.lag[s], walk_back(ancestor, particles, first, s)) << run << " " << s;
    }
  }
}

TEST(Diversity, NeverGrowsAtTheRoot) {
  DiversityCounter counter;
  RngStream draw({4, 0, 0, 0, Draw::test});
  const auto& root = counter.count(random_genealogy(100, 200, draw), 100, scan_times(200)).root;
  for (std::size_t s = 1; s < root.size(); ++s) EXPECT_LE(root[s], root[s - 1]);
  EXPECT_LT(root.back(), 10u);
}

TEST(Diversity, RefusesAParentThatDoesNotExist) {
  DiversityCounter counter;
  const std::vector<std::uint32_t> ancestor = {0, 1, 2, 3};
  EXPECT_THROW(counter.count(ancestor, 2, scan_times(2)), RunError);
}

}  // namespace
}  // namespace montecarta::analysis
