// SPDX-License-Identifier: BSD-3-Clause
// Vehicles other than cars, simulated.
#include "engine/errors.hpp"
#include "experiments/drives/simulated_drive.hpp"
#include "experiments/worlds/world.hpp"
#include "filters/models/ackermann.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/filters/some_models.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

/// A narrow way there and back: at both ends the next way-point is behind.
World there_and_back() {
  World world;
  world.name = "there_and_back";
  world.landmarks = {{5.0, 3.0}, {15.0, -3.0}};
  world.waypoints = {{20.0, 0.0}, {0.0, 0.0}};
  return world;
}

Scenario scenario_of(const Vehicle& vehicle) {
  return {.noise = NoiseMode::matched,
          .vehicle = vehicle,
          .speed = 1.0,
          .control = {.sigma = {0.1, 0.05, 0.05}},
          .waypoint_radius = 0.3};
}

class EveryVehicleDrives : public testing::TestWithParam<SomeVehicle> {};

TEST_P(EveryVehicleDrives, ThroughAShippedWorldAndTheSameAgain) {
  const SimulatedDrive source(find_world("web_loop"), {.vehicle = GetParam().vehicle}, 3);
  Drive first, again;
  source.generate(5, first);
  source.generate(6, again);
  source.generate(5, again);
  ASSERT_EQ(first.controls.size(), again.controls.size());
  const auto same = [](const Control& a, const Control& b) { return a.values == b.values; };
  EXPECT_TRUE(std::ranges::equal(first.controls, again.controls, same));
  EXPECT_GT(first.detections.size(), 1000U);
}

INSTANTIATE_TEST_SUITE_P(All, EveryVehicleDrives, testing::ValuesIn(some_vehicles()),
                         [](const auto& instance) { return instance.param.name; });

TEST(VehicleDrive, ADifferentialDriveTurnsOnTheSpotAndThatIsNoStanding) {
  const SimulatedDrive source(there_and_back(), scenario_of(DifferentialDrive{}), 1);
  EXPECT_EQ(source.itinerary().moving_controls, 2U);
  Drive drive;
  source.generate(0, drive);
  const auto on_spot = [](const Control& c) { return c[0] == 0.0 && c[1] != 0.0; };
  const auto turns = std::ranges::count_if(drive.controls, on_spot);
  // 135 of 180 degrees at 90 deg/s and 40 Hz
  EXPECT_GT(turns, 50);
  EXPECT_LT(turns, 80);
  for (const Control& control : drive.controls) EXPECT_FALSE(control.stands(2));
}

/// Mean square of the difference between given and obeyed controls, by component.
Eigen::Array2d noise_of(const SimulatedDrive& noisy, const SimulatedDrive& exact) {
  Drive a, b;
  noisy.generate(0, a), exact.generate(0, b);
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  for (std::size_t k = 0; k < a.controls.size(); ++k) {
    const Control &with = a.controls[k], &without = b.controls[k];
    const Eigen::Array2d error(with[0] - without[0], with[1] - without[1]);
    sum += error.square();
  }
  return sum / static_cast<double>(a.controls.size());
}

TEST(VehicleDrive, SaysThatItStepsOverAWaypoint) {
  Scenario scenario = scenario_of(Omnidirectional{});
  scenario.speed = 300.0;
  scenario.control_rate = 20.0;
  EXPECT_THAT(engine::complaint_of([&] { SimulatedDrive(there_and_back(), scenario, 1); }),
              testing::HasSubstr("steps over it, 15 m at a time"));
}

TEST(VehicleDrive, NoiseThatGrowsWithTheMotionHasTheVarianceThatIsSaid) {
  Scenario scenario = scenario_of(Car{.wheelbase = 1.0});
  scenario.noise = NoiseMode::measured_control;
  scenario.loops = 20;
  scenario.control = {.sigma = {0.1, 0.05}, .alpha = {0.04, 0.0, 0.01, 0.0}};
  Scenario exact = scenario;
  exact.control = {};
  const World world = there_and_back();
  const Eigen::Array2d found =
      noise_of(SimulatedDrive(world, scenario, 1), SimulatedDrive(world, exact, 1));
  const Eigen::Array2d expected(0.01 + 0.04, 0.0025 + 0.01);
  // n > 30,000 steps: a variance is good to 0.8 %
  EXPECT_TRUE(((found / expected - 1.0).abs() < 0.04).all()) << found;
}

TEST(Omnidirectional, WithoutMotionToTheLeftIsADifferentialDrive) {
  for (const double turn : {0.0, 0.3, -2.0}) {
    const auto one = body_step(DifferentialDrive{}, Control{1.5, turn}, 0.4);
    const auto other = body_step(Omnidirectional{}, Control{1.5, 0.0, turn}, 0.4);
    EXPECT_EQ(one.forward, other.forward);
    EXPECT_EQ(one.left, other.left);
    EXPECT_EQ(one.turn, other.turn);
  }
}

TEST(ControlNoise, CountsBothComponentsOfAVelocity) {
  const ControlNoise noise{.sigma = {}, .alpha = {1.0, 0.0, 4.0, 0.0}};
  const auto sigma = deviations_of(noise, {3.0, 4.0, 0.5}, Omnidirectional{});
  EXPECT_DOUBLE_EQ(sigma[0], 5.0);
  EXPECT_DOUBLE_EQ(sigma[1], 5.0);
  EXPECT_DOUBLE_EQ(sigma[2], 10.0);
}

TEST(Omnidirectional, DrivesStraightToTheWayPointWhileItTurns) {
  const SimulatedDrive source(there_and_back(), scenario_of(Omnidirectional{}), 1);
  EXPECT_EQ(source.itinerary().moving_controls, 3U);
  Drive drive;
  source.generate(0, drive);
  for (const Control& control : drive.controls) {
    EXPECT_NEAR(std::hypot(control[0], control[1]), 1.0, 1e-12);
  }
  EXPECT_TRUE(std::ranges::any_of(drive.controls, [](const Control& c) { return c[0] < -0.9; }));
}

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
  const auto only_detection = [&] {
    std::vector<Detection> detections;
    const SimulatedSensor sensor(scenario);
    sensor.see(Pose{}, landmarks, [&](const VisibleLandmark& one) {
      sensor.detect(one, {.seed = 3, .run = 1, .step = 0}, detections);
    });
    EXPECT_EQ(detections.size(), 1U) << "one is too near, one too far";
    return detections.at(0);
  };
  EXPECT_NEAR(only_detection()[0], 5.0, 1e-12);
  EXPECT_NEAR(only_detection()[1], 3.0, 1e-12);
  scenario.sensor.kind = RangeSensor();
  EXPECT_NEAR(only_detection()[0], std::hypot(5.0, 3.0), 1e-12);
  EXPECT_EQ(only_detection()[1], 0.0);
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
