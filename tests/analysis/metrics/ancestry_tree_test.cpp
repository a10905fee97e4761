// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/ancestry_figure.hpp"
#include "analysis/metrics/lineages.hpp"
#include "engine/errors.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

namespace montecarta::analysis {
namespace {

using Branch = AncestryTree::Branch;

std::vector<double> seconds_of_scans(std::size_t scans) {
  std::vector<double> times;
  for (std::size_t s = 0; s < scans; ++s) times.push_back(static_cast<double>(s + 1));
  return times;
}

/// {scan, particle} every child's parent is any particle, in most scans itself.
std::vector<std::uint32_t> random_ancestry(std::uint64_t run, std::size_t scans, std::size_t n) {
  RngStream draw({41, run, 0, 0, Draw::test});
  std::vector<std::uint32_t> ancestor;
  for (std::size_t s = 0; s < scans; ++s) {
    const bool resampled = draw.uniform() < 0.2;
    for (std::uint32_t i = 0; i < n; ++i) {
      const bool moves = resampled && draw.uniform() < 0.3;
      ancestor.push_back(moves ? static_cast<std::uint32_t>(draw.uniform() * static_cast<double>(n))
                               : i);
    }
  }
  return ancestor;
}

// Three particles at scans 1, 2, 3 s: 1 and 2 are children of 1 of scan 2, whose parent, like 0's,
// is 2 of scan 1.
TEST(AncestryTree, OfThreeParticlesByHand) {
  const std::vector<std::uint32_t> ancestor = {0, 1, 2, 2, 2, 0, 0, 1, 1};
  const AncestryTree tree = ancestry_tree(ancestor, 3, seconds_of_scans(3), 10);
  ASSERT_EQ(tree.branches.size(), 5u);
  const auto expect_branch = [&](std::size_t b, std::size_t parent, double from, double to,
                                 std::size_t leaves, double height) {
    const Branch& branch = tree.branches[b];
    EXPECT_EQ(branch.parent, parent) << b;
    EXPECT_EQ(branch.from, from) << b;
    EXPECT_EQ(branch.to, to) << b;
    EXPECT_EQ(branch.leaves, leaves) << b;
    EXPECT_EQ(branch.height, height) << b;
  };
  expect_branch(0, 4, 1.0, 3.0, 1, 1.0);
  expect_branch(1, 3, 2.0, 3.0, 1, 2.0);
  expect_branch(2, 3, 2.0, 3.0, 1, 3.0);
  expect_branch(3, 4, 1.0, 2.0, 2, 2.5);
  expect_branch(4, AncestryTree::kNone, 0.0, 1.0, 3, 1.75);
  EXPECT_EQ(tree.common_ancestor(), 1.0);
}

TEST(AncestryTree, HasAsManyLinesAtAnyTimeAsThereAreAncestors) {
  for (std::uint64_t run = 0; run < 40; ++run) {
    constexpr std::size_t kScans = 60, kParticles = 12;
    const auto ancestor = random_ancestry(run, kScans, kParticles);
    const AncestryTree tree =
        ancestry_tree(ancestor, kParticles, seconds_of_scans(kScans), kParticles);
    AncestorSet alive;
    alive.start(kParticles);
    for (std::size_t s = kScans; s-- > 0;) {
      const double between = static_cast<double>(s) + 0.5;  // scan s is at s + 1 seconds_of_scans
      const auto lines = std::ranges::count_if(tree.branches, [&](const Branch& branch) {
        return branch.from < between && between < branch.to;
      });
      EXPECT_EQ(static_cast<std::size_t>(lines), alive.size()) << "run " << run << " scan " << s;
      alive.step_back(std::span(ancestor).subspan(s * kParticles, kParticles));
    }
    EXPECT_EQ(tree.common_ancestor() > 0.0, tree.branches.back().leaves == kParticles);
  }
}

/// Heights of the leaves that descend from branch `b`.
std::set<double> leaves_of(const AncestryTree& tree, std::size_t b) {
  std::set<double> heights;
  for (std::size_t leaf = 0; leaf < tree.leaves; ++leaf) {
    std::size_t up = leaf;
    while (up != b && up != AncestryTree::kNone) up = tree.branches[up].parent;
    if (up == b) heights.insert(tree.branches[leaf].height);
  }
  return heights;
}

TEST(AncestryTree, CrossesNoLines) {
  for (std::uint64_t run = 0; run < 20; ++run) {
    const auto ancestor = random_ancestry(run, 60, 12);
    const AncestryTree tree = ancestry_tree(ancestor, 12, seconds_of_scans(60), 12);
    for (std::size_t b = 0; b < tree.branches.size(); ++b) {
      const std::set<double> family = leaves_of(tree, b);
      // A family has its stretch of heights to itself, and its line begins within.
      EXPECT_EQ(family.size(), tree.branches[b].leaves);
      EXPECT_EQ(*family.rbegin() - *family.begin() + 1.0, static_cast<double>(family.size()));
      EXPECT_GE(tree.branches[b].height, *family.begin());
      EXPECT_LE(tree.branches[b].height, *family.rbegin());
    }
  }
}

TEST(AncestryTree, FollowsSomeOfTooManyParticlesEvenly) {
  // Particles 0 to 4 are one family, 5 to 9 another: three of ten see both.
  const std::vector<std::uint32_t> ancestor = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9,   // of 1 s
                                               0, 0, 0, 0, 0, 5, 5, 5, 5, 5};  // of 2 s
  const AncestryTree tree = ancestry_tree(ancestor, 10, seconds_of_scans(2), 3);
  EXPECT_EQ(tree.leaves, 3u);
  EXPECT_EQ(tree.particles, 10u);
  ASSERT_EQ(tree.branches.size(), 4u);  // 0 and 3 meet; 6 stays alone
  EXPECT_EQ(tree.branches[2].parent, AncestryTree::kNone);
  EXPECT_EQ(tree.branches[3].leaves, 2u);
  EXPECT_EQ(tree.common_ancestor(), 0.0);
}

TEST(AncestryTree, RefusesParentsThatAreNot) {
  EXPECT_THROW(ancestry_tree(std::vector<std::uint32_t>{0, 2}, 2, seconds_of_scans(1), 2),
               RunError);
}

}  // namespace
}  // namespace montecarta::analysis
