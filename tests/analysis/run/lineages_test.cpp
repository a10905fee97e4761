// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/lineages.hpp"

#include "analysis/render/figures/ancestry_figure.hpp"
#include "analysis/study/lineage_sums.hpp"
#include "engine/errors.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/reported.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/doubles/matchers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Of scans that are one second apart.
Lineages lineages_of(const RunRows& rows, std::size_t particles, std::size_t scans,
                     std::span<const double> squared_position = {}) {
  std::vector<std::size_t> resampled;
  find_resamplings(rows.ancestor, particles, resampled);
  return LineageWalker().walk(rows, resampled, scan_times(scans), squared_position);
}

/// Twenty scans, one a second, of four particles: nobody is replaced but before scan 10 (from 0),
/// when 0 and 1 take over, and before scan 15, when all become children of 2, who is one of 1's.
RunRows two_resamplings() {
  RunRows rows;
  for (int s = 0; s < 20; ++s) {
    const std::vector<std::uint32_t> parents = s == 10   ? std::vector<std::uint32_t>{0, 0, 1, 1}
                                               : s == 15 ? std::vector<std::uint32_t>{2, 2, 2, 2}
                                                         : std::vector<std::uint32_t>{0, 1, 2, 3};
    rows.ancestor.insert(rows.ancestor.end(), parents.begin(), parents.end());
  }
  return rows;
}

// Twenty scans are all looked at. A scan s >= 15 looks back s - 14 seconds to the common ancestor.
TEST(Lineages, KnowTwoResamplingsByHand) {
  const Lineages found = lineages_of(two_resamplings(), 4, 20);
  EXPECT_DOUBLE_EQ(found.coalesced_share, 5.0 / 20.0);
  EXPECT_NEAR(found.coalescence, (1.0 + 2.0 + 3.0 + 4.0 + 5.0) / 5.0, 1e-6);
  // One second back: scan 10 sees 2, scan 15 sees 1, the others 4.
  EXPECT_DOUBLE_EQ(found.ancestors[0], (18 * 4.0 + 2.0 + 1.0) / 20.0);
  EXPECT_DOUBLE_EQ(found.ancestors[4], 1.0);
  EXPECT_TRUE(std::isnan(found.ancestors[6]));
  EXPECT_TRUE(std::isnan(found.monte_carlo_variance));
}

// Independent particles that are never resampled: the variance of their mean is variance / M.
TEST(Lineages, GiveTheVarianceOfAMeanOfIndependentParticles) {
  constexpr std::size_t kParticles = 500, kSeconds = 40;
  RngStream draw({31, 0, 0, 0, Draw::test});
  RunRows rows;
  for (std::size_t s = 0; s < kSeconds; ++s) {
    for (std::uint32_t i = 0; i < kParticles; ++i) {
      rows.ancestor.push_back(i);
      rows.log_weight.push_back(-std::log(static_cast<double>(kParticles)));
      for (const double value : {10.0 + 2.0 * draw.normal(), 1.0 * draw.normal() - 5.0, 0.0})
        rows.particle_pose.push_back(value);
    }
  }
  const Lineages found = lineages_of(rows, kParticles, kSeconds);
  const double expected = (4.0 + 1.0) / static_cast<double>(kParticles);
  EXPECT_NEAR(found.monte_carlo_variance, expected, 0.1 * expected);
}

// Families {0, 1} and {2} of the last ten seconds, with weights 0.5, 0.2, 0.3 at x = 10, 12, 20:
// the mean is 13.4, and the families pull it by 1.98 to either side.
TEST(Lineages, WeighFamiliesByHand) {
  RunRows rows;
  for (int s = 0; s < 12; ++s) {
    rows.ancestor.insert(rows.ancestor.end(), {0, s == 5 ? 0u : 1u, 2});
    for (const double weight : {0.5, 0.2, 0.3}) rows.log_weight.push_back(std::log(weight));
    for (const double x : {10.0, 12.0, 20.0}) {
      rows.particle_pose.insert(rows.particle_pose.end(), {x, 7.0, 0.0});
    }
  }
  const Lineages found = lineages_of(rows, 3, 12);
  EXPECT_NEAR(found.monte_carlo_variance, 2.0 * 1.98 * 1.98, 1e-9);
}

// Every second one of 64 scans is used, the last one among them.
TEST(Lineages, LookAtErrorsOfTheSameScans) {
  RunRows rows;
  std::vector<double> squares;
  for (std::uint32_t s = 0; s < 64; ++s) {
    rows.ancestor.insert(rows.ancestor.end(), {0, 1});
    squares.push_back(static_cast<double>(s));
  }
  EXPECT_DOUBLE_EQ(lineages_of(rows, 2, 64, squares).squared_error, 32.0);
}

TEST(LineageSums, AverageWhatRunsHave) {
  Lineages one, other;
  one.ancestors.fill(2.0);
  one.coalescence = std::nan("");
  one.monte_carlo_variance = 0.5;
  one.squared_error = 2.0;
  other = one;
  other.coalescence = 4.0;
  other.ancestors[6] = std::nan("");
  LineageSums sums;
  sums.add(one);
  sums.add(other);
  EXPECT_DOUBLE_EQ(sums.result().coalescence, 4.0);
  EXPECT_DOUBLE_EQ(sums.result().ancestors[6], 2.0);
  EXPECT_DOUBLE_EQ(sums.result().monte_carlo_share, 0.25);
}

TEST(DiversityTable, SaysWhatFewParticlesCost) {
  StudyAnalysis study;
  CellAnalysis& cell = study.cells.emplace_back();
  cell.scan_series = {{"ess", "1", {5.0}}};
  LineageSummary lineages;
  lineages.monte_carlo_share = 0.125;
  cell.findings.put(lineages);
  const TextTable table = reported_table(study, "diversity");
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.headings.back().text, "Monte Carlo share");
  EXPECT_EQ(table.rows[0].back(), "12.5 %");
}

using Branch = AncestryTree::Branch;

/// {scan, particle} A child's parent is any particle, in most scans itself.
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

// Three particles at scans 1, 2, 3 s: 1 and 2 are children of 1 of scan 2. The parent of that one,
// and of 0, is 2 of scan 1.
TEST(AncestryTree, OfThreeParticlesByHand) {
  const std::vector<std::uint32_t> ancestor = {0, 1, 2, 2, 2, 0, 0, 1, 1};
  const AncestryTree tree = ancestry_tree(ancestor, 3, scan_times(3), 10);
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
    const AncestryTree tree = ancestry_tree(ancestor, kParticles, scan_times(kScans), kParticles);
    AncestorSet alive;
    alive.start(kParticles);
    for (std::size_t s = kScans; s-- > 0;) {
      const double between = static_cast<double>(s) + 0.5;  // scan s is at s + 1 seconds
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
    const AncestryTree tree = ancestry_tree(ancestor, 12, scan_times(60), 12);
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
  const AncestryTree tree = ancestry_tree(ancestor, 10, scan_times(2), 3);
  EXPECT_EQ(tree.leaves, 3u);
  EXPECT_EQ(tree.particles, 10u);
  ASSERT_EQ(tree.branches.size(), 4u);  // 0 and 3 meet; 6 stays alone
  EXPECT_EQ(tree.branches[2].parent, AncestryTree::kNone);
  EXPECT_EQ(tree.branches[3].leaves, 2u);
  EXPECT_EQ(tree.common_ancestor(), 0.0);
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

TEST(Diversity, EqualsWalkingBackEveryParticle) {
  DiversityCounter counter;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const std::size_t particles = 5 + 3 * run, scans = 40;
    const auto ancestor = random_ancestry(run, scans, particles);
    const Diversity& found = counter.count(ancestor, particles, scan_times(scans));
    for (std::size_t s = 0; s < scans; ++s) {
      EXPECT_EQ(found.root[s], walk_back(ancestor, particles, 0, s)) << run << " " << s;
      const std::size_t first = s < 10 ? 0 : s - 9;
      EXPECT_EQ(found.lag[s], walk_back(ancestor, particles, first, s)) << run << " " << s;
    }
  }
}

TEST(Diversity, RefusesAParentThatDoesNotExist) {
  DiversityCounter counter;
  const std::vector<std::uint32_t> ancestor = {0, 1, 2, 3};
  EXPECT_THROW(counter.count(ancestor, 2, scan_times(2)), RunError);
}

}  // namespace
}  // namespace montecarta::analysis
