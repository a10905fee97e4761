// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/simulated_sensor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<int> seen_from(const Pose& pose, const Scenario& scenario,
                           const std::vector<Eigen::Vector2d>& landmarks) {
  std::vector<int> identities;
  SimulatedSensor(scenario).see(pose, landmarks, [&](const VisibleLandmark& observation) {
    identities.push_back(observation.identity);
  });
  return identities;
}

std::vector<Detection> scan_of(const Scenario& scenario, std::uint32_t step,
                               const std::vector<VisibleLandmark>& observations) {
  std::vector<Detection> detections;
  const StreamIdentity place{.seed = 3, .run = 1, .step = step};
  for (const VisibleLandmark& observation : observations)
    SimulatedSensor(scenario).detect(observation, place, detections);
  SimulatedSensor(scenario).add_clutter(place, detections);
  return detections;
}

TEST(SimulatedSensor, SeesStrictlyWithinRangeAndView) {
  const std::vector<Eigen::Vector2d> landmarks = {{10, 0},   {9.99, 0}, {0, 5},
                                                  {0.01, 5}, {-3, 0},   {3, -3.01}};
  EXPECT_THAT(seen_from(Pose{}, {.max_range = 10.0}, landmarks), ElementsAre(1, 3, 5));
  EXPECT_THAT(seen_from(Pose{}, {.max_range = 10.0, .field_of_view = kPi / 2}, landmarks),
              ElementsAre(1));
  EXPECT_THAT(seen_from(Pose{}, {.max_range = 10.0, .field_of_view = kTwoPi}, landmarks),
              ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(seen_from(Pose{0, 0, -2.5}, {.max_range = 10.0}, landmarks), ElementsAre(4));
}

TEST(SimulatedSensor, WrapsBearingsAndKeepsRangesPositive) {
  const Scenario wild{.sigma_range = 5.0, .sigma_bearing = 3.0};
  for (std::uint32_t step = 0; step < 500; ++step) {
    const Detection detection = scan_of(wild, step, {{0, {0.5, 1.0}}}).front();
    EXPECT_GE(detection[0], kLeastRange);
    EXPECT_EQ(detection[1], wrap(detection[1]));
  }
}

TEST(SimulatedSensor, GivesEveryLandmarkItsOwnNoise) {
  const Scenario scenario;
  const auto both = scan_of(scenario, 7, {{4, {10.0, 0.1}}, {9, {12.0, -0.4}}});
  const auto alone = scan_of(scenario, 7, {{9, {12.0, -0.4}}});
  EXPECT_EQ(both[1][0], alone[0][0]);
  EXPECT_EQ(both[1][1], alone[0][1]);
}

TEST(SimulatedSensor, SeesFromWhereItIsMountedWhatItMeasures) {
  Scenario scenario{.max_range = 10.0, .min_range = 2.0};
  scenario.sigma_forward = scenario.sigma_left = scenario.sigma_range = 0.0;
  scenario.sensor = {PositionSensor(), {.forward = 1.0, .left = 2.0, .turn = kPi / 2}};
  const std::vector<Eigen::Vector2d> landmarks = {{-2, 7}, {1, 3}, {20, 7}};
  const StreamIdentity place{.seed = 3, .run = 1, .step = 0};
  std::vector<Detection> detections;
  const SimulatedSensor sensor(scenario);
  sensor.see(Pose{}, landmarks,
             [&](const VisibleLandmark& one) { sensor.detect(one, place, detections); });
  ASSERT_EQ(detections.size(), 1U) << "one is too near, one too far";
  EXPECT_NEAR(detections[0][0], 5.0, 1e-12);
  EXPECT_NEAR(detections[0][1], 3.0, 1e-12);
  scenario.sensor.kind = RangeSensor();
  detections.clear();
  SimulatedSensor(scenario).see(Pose{}, landmarks, [&](const VisibleLandmark& one) {
    SimulatedSensor(scenario).detect(one, place, detections);
  });
  EXPECT_NEAR(detections[0][0], std::hypot(5.0, 3.0), 1e-12);
  EXPECT_EQ(detections[0][1], 0.0);
}

// Rates within 5 standard errors.
TEST(SimulatedSensor, MissesAndAddsClutterAtTheNamedRates) {
  const Scenario scenario{.max_range = 20.0, .clutter_rate = 1.5, .miss_probability = 0.25};
  const double n = 20'000;
  double missed = 0.0;
  double clutter = 0.0;
  double mean_square_range = 0.0;
  for (std::uint32_t step = 0; step < 20'000; ++step) {
    missed += 1.0;
    for (const Detection& detection : scan_of(scenario, step, {{0, {10.0, 0.0}}})) {
      if (detection.identity == 0) {
        missed -= 1.0;
        continue;
      }
      clutter += 1.0;
      mean_square_range += detection[0] * detection[0];
      EXPECT_LE(std::abs(detection[1]), kPi / 2);
    }
  }
  EXPECT_NEAR(missed / n, 0.25, 5.0 * std::sqrt(0.25 * 0.75 / n));
  EXPECT_NEAR(clutter / n, 1.5, 5.0 * std::sqrt(1.5 / n));
  EXPECT_NEAR(mean_square_range / clutter, 200.0, 5.0 * 400.0 / std::sqrt(12.0 * clutter))
      << "uniform over the area";
}

TEST(SimulatedSensor, PutsClutterLast) {
  const auto scan = scan_of({.clutter_rate = 20.0}, 0, {{0, {10.0, 0.0}}, {5, {10.0, 0.0}}});
  ASSERT_GT(scan.size(), 2U);
  EXPECT_EQ(scan[0].identity, 0);
  EXPECT_EQ(scan[1].identity, 5);
  EXPECT_EQ(scan[2].identity, Detection::kClutter);
  EXPECT_THAT(scan_of({.miss_probability = 1.0}, 0, {{0, {10.0, 0.0}}}), IsEmpty());
}

}  // namespace
}  // namespace montecarta::experiments
