// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/angle.hpp"
#include "experiments/recordings/laser.hpp"

#include <gtest/gtest.h>

#include <array>

namespace montecarta::experiments {
namespace {

using Ranges = std::array<double, kLaserBeams>;

/// Echoes of `range` at beams first to last.
struct Surface {
  std::size_t first, last;
  double range;
};

Ranges sweep_of(std::initializer_list<Surface> surfaces) {
  Ranges ranges;
  ranges.fill(81.91);
  for (const auto& [first, last, range] : surfaces) {
    for (std::size_t beam = first; beam <= last; ++beam) ranges[beam] = range;
  }
  return ranges;
}

std::vector<Detection> trees_in(std::initializer_list<Surface> surfaces) {
  return detect_trees(sweep_of(surfaces));
}

TEST(TreeDetector, FindsTheCentreOfATrunk) {
  const auto trees = trees_in({{199, 202, 10.0}});
  ASSERT_EQ(trees.size(), 1U);
  const double diameter = 4 * kPi / 360 * 10;
  EXPECT_NEAR(trees[0][0], 10 + diameter / 2, 1e-12);
  EXPECT_NEAR(trees[0][1], 20.5 * kPi / 360, 1e-12) << "half way, counter-clockwise of ahead";
  EXPECT_EQ(trees[0].identity, Detection::kUnidentified);
}

TEST(TreeDetector, TakesTheTwoMiddleBeamsForTheRange) {
  Ranges ranges = sweep_of({{199, 202, 10.0}});
  ranges[200] = 9.8;
  ranges[201] = 9.7;
  EXPECT_NEAR(detect_trees(ranges)[0][0], 9.75 + 4 * kPi / 360 * 10 / 2, 1e-12);
  Ranges odd = sweep_of({{199, 201, 10.0}});
  odd[200] = 9.8;
  EXPECT_NEAR(detect_trees(odd)[0][0], 9.8 + 3 * kPi / 360 * 10 / 2, 1e-12);
}

TEST(TreeDetector, Step1LeavesOutWhatIsTooFar) {
  EXPECT_EQ(trees_in({{200, 200, 74.9}}).size(), 1U);
  EXPECT_TRUE(trees_in({{200, 200, 75.0}}).empty());
  EXPECT_TRUE(trees_in({}).empty());
}

TEST(TreeDetector, Step2CutsWhereRangeOrAngleSteps) {
  // A step there and back is one trunk, or three segments that crowd each other.
  EXPECT_EQ(trees_in({{150, 151, 20.0}, {152, 152, 21.4}, {153, 154, 20.0}}).size(), 1U);
  EXPECT_EQ(trees_in({{150, 151, 20.0}, {152, 152, 21.6}, {153, 154, 20.0}}).size(), 0U);
  // Two beams 9 apart are one trunk; 11 apart two segments that crowd each other.
  EXPECT_EQ(trees_in({{200, 200, 2.0}, {209, 209, 2.0}}).size(), 1U);
  EXPECT_EQ(trees_in({{200, 200, 2.0}, {211, 211, 2.0}}).size(), 0U);
}

TEST(TreeDetector, Step3WantsTrunksToStandAlone) {
  const std::size_t three_metres = 18;  // beams at 20 m: 3.14 m
  EXPECT_EQ(trees_in({{200, 201, 20}, {201 + three_metres, 219, 20}}).size(), 2U);
  EXPECT_EQ(trees_in({{200, 201, 20}, {201 + three_metres - 2, 218, 20}}).size(), 0U);
  // One, two, but not three far segments may stand between the two.
  EXPECT_EQ(trees_in({{200, 201, 20}, {204, 204, 50}, {214, 215, 20}}).size(), 1U);
  EXPECT_EQ(trees_in({{200, 201, 20}, {204, 204, 50}, {207, 207, 40}, {214, 215, 20}}).size(), 2U);
  EXPECT_EQ(
      trees_in({{200, 201, 20}, {204, 204, 50}, {207, 207, 40}, {210, 210, 60}, {214, 215, 20}})
          .size(),
      5U);
}

TEST(TreeDetector, Step4DiscardsWhatIsPartlyHidden) {
  const auto left_hidden = trees_in({{200, 202, 10}, {203, 203, 20}});
  ASSERT_EQ(left_hidden.size(), 1U);
  EXPECT_LT(left_hidden[0][0], 11);
  const auto right_hidden = trees_in({{200, 200, 20}, {201, 203, 10}});
  ASSERT_EQ(right_hidden.size(), 1U);
  EXPECT_LT(right_hidden[0][0], 11);
  EXPECT_EQ(trees_in({{200, 202, 10}, {205, 205, 20}}).size(), 2U) << "1.5 deg apart";
}

TEST(TreeDetector, Step4HidesBehindSegmentsThatAreNoTrunks) {
  // Two crowded segments (step 3) near the vehicle; the last hides part of the one behind.
  EXPECT_EQ(trees_in({{190, 191, 10}, {194, 196, 10.0}, {197, 197, 20}}).size(), 1U)
      << "one segment of 10 m, and what it hides";
  EXPECT_EQ(trees_in({{180, 181, 10}, {193, 196, 10.0}, {197, 197, 20}}).size(), 0U);
}

TEST(TreeDetector, Step5WantsAShortChordFarFromTheVehicleAndTheEdges) {
  EXPECT_EQ(trees_in({{200, 211, 10}}).size(), 1U) << "chord 0.96 m";
  EXPECT_EQ(trees_in({{200, 212, 10}}).size(), 0U) << "chord 1.05 m";
  EXPECT_EQ(trees_in({{200, 201, 1.1}}).size(), 1U);
  EXPECT_EQ(trees_in({{200, 201, 1.0}}).size(), 0U);
  EXPECT_EQ(trees_in({{6, 8, 10}}).size(), 1U);
  EXPECT_EQ(trees_in({{5, 8, 10}}).size(), 0U);
  EXPECT_EQ(trees_in({{352, 354, 10}}).size(), 1U);
  EXPECT_EQ(trees_in({{352, 355, 10}}).size(), 0U);
}

TEST(TreeDetector, Step7RefusesSurfacesThatLeadAway) {
  const double third = 4 * kPi / 360 * 10 / 3;  // of the diameter of four beams at 10 m
  EXPECT_EQ(trees_in({{200, 202, 10}, {203, 203, 10 + 0.9 * third}}).size(), 1U);
  EXPECT_EQ(trees_in({{200, 202, 10}, {203, 203, 10 + 1.1 * third}}).size(), 0U);
}

}  // namespace
}  // namespace montecarta::experiments
