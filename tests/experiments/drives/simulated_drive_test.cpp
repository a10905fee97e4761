// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/simulated_drive.hpp"

#include "engine/errors.hpp"
#include "experiments/worlds/world.hpp"
#include "filters/models/ackermann.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/published_data.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

namespace montecarta::experiments {
namespace {

Drive drive_of(const SimulatedDrive& source, std::uint64_t run) {
  Drive drive;
  source.generate(run, drive);
  return drive;
}

bool same_controls(const Drive& a, const Drive& b) {
  return std::ranges::equal(a.controls, b.controls, [](const Control& x, const Control& y) {
    return x[0] == y[0] && x[1] == y[1];
  });
}

bool same_numbers(const Drive& a, const Drive& b) {
  const auto same_detection = [](const Detection& x, const Detection& y) {
    return x[0] == y[0] && x[1] == y[1] && x.identity == y.identity;
  };
  const auto same_pose = [](const Pose& x, const Pose& y) { return boxminus(x, y).isZero(0.0); };
  return std::ranges::equal(a.detections, b.detections, same_detection) && same_controls(a, b) &&
         std::ranges::equal(a.truth, b.truth, same_pose) && a.scan_begin == b.scan_begin;
}

struct SeenLandmarks {
  double mean = 0.0;         ///< visible in a scan
  double empty_share = 0.0;  ///< of scans
  std::size_t different = 0;
};

SeenLandmarks seen_in(const Drive& drive) {
  SeenLandmarks seen;
  const std::size_t scans = drive.scan_begin.size() - 1;
  std::set<std::int32_t> different;
  for (const Detection& detection : drive.detections) different.insert(detection.identity);
  for (std::size_t s = 0; s < scans; ++s)
    seen.empty_share += drive.scan(s).empty() ? 1.0 / static_cast<double>(scans) : 0.0;
  seen.mean = static_cast<double>(drive.detections.size()) / static_cast<double>(scans);
  seen.different = different.size();
  return seen;
}

TEST(SimulatedDrive, DrivesTheShippedWorldsAsTheyPromise) {
  const SimulatedDrive web(find_world("web_loop"), Scenario{}, 1);
  EXPECT_NEAR(static_cast<double>(web.itinerary().steps()) * 0.075, 640.0, 10.0);
  EXPECT_NEAR(seen_in(drive_of(web, 0)).mean, 1.2, 0.2);
  EXPECT_NEAR(seen_in(drive_of(web, 0)).empty_share, 0.2, 0.05);
  const SimulatedDrive dense(find_world("dense_loop"), Scenario{}, 1);
  EXPECT_NEAR(seen_in(drive_of(dense, 0)).mean, 5.2, 0.3);
  const Scenario small{.vehicle = Car{.wheelbase = 0.26}, .speed = 0.8, .max_range = 5.0};
  EXPECT_EQ(seen_in(drive_of(SimulatedDrive(find_world("small_loop"), small, 1), 0)).different, 15U)
      << "reached with the default radius and steering rate, too";
}

TEST(SimulatedDrive, IsAFunctionOfSeedAndRunWhateverTheBuffersHeld) {
  for (const NoiseMode noise : {NoiseMode::measured_control, NoiseMode::matched}) {
    const Scenario scenario{.noise = noise, .clutter_rate = 0.5, .miss_probability = 0.2};
    const SimulatedDrive source(find_world("web_loop"), scenario, 5);
    Drive reused;
    source.generate(3, reused);
    source.generate(7, reused);
    EXPECT_TRUE(
        same_numbers(reused, drive_of(SimulatedDrive(find_world("web_loop"), scenario, 5), 7)));
    EXPECT_FALSE(same_numbers(reused, drive_of(source, 8)));
    EXPECT_FALSE(
        same_numbers(reused, drive_of(SimulatedDrive(find_world("web_loop"), scenario, 6), 7)));
  }
}

TEST(SimulatedDrive, SharesOneTruthWhereOnlyTheMeasuredControlIsNoisy) {
  const SimulatedDrive source(find_world("web_loop"), Scenario{}, 5);
  const Drive a = drive_of(source, 0);
  const Drive b = drive_of(source, 1);
  EXPECT_EQ(a.truth[5000].x, b.truth[5000].x);
  EXPECT_EQ(a.scan_begin, b.scan_begin);
  EXPECT_NE(a.controls[5000][1], b.controls[5000][1]);
}

// Mean and standard deviation of (true control - given control) within 5 standard errors.
TEST(SimulatedDrive, DrawsTheNoiseThatTheScenarioNames) {
  const Scenario scenario{
      .control = {.sigma = {0.3, 0.05}}, .sigma_range = 0.2, .sigma_bearing = 0.02};
  const Drive noisy = drive_of(SimulatedDrive(find_world("dense_loop"), scenario, 9), 0);
  const Scenario silent{.control = {.sigma = {0.0, 0.0}}, .sigma_range = 0.0, .sigma_bearing = 0.0};
  const Drive exact = drive_of(SimulatedDrive(find_world("dense_loop"), silent, 9), 0);
  Eigen::Array4d sum = Eigen::Array4d::Zero();
  Eigen::Array4d squares = Eigen::Array4d::Zero();
  const std::size_t count = exact.detections.size();
  ASSERT_EQ(noisy.detections.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Array4d error = {noisy.controls[i][0] - exact.controls[i][0],
                                  noisy.controls[i][1] - exact.controls[i][1],
                                  noisy.detections[i][0] - exact.detections[i][0],
                                  wrap(noisy.detections[i][1] - exact.detections[i][1])};
    sum += error;
    squares += error * error;
  }
  const double n = static_cast<double>(count);
  const Eigen::Array4d sigma = {0.3, 0.05, 0.2, 0.02};
  EXPECT_TRUE(((sum / n).abs() < 5.0 * sigma / std::sqrt(n)).all()) << (sum / n).transpose();
  EXPECT_TRUE((((squares / n).sqrt() / sigma - 1.0).abs() < 5.0 / std::sqrt(2.0 * n)).all())
      << (squares / n).sqrt().transpose();
}

TEST(SimulatedDrive, MovesTheTruthByTheNoiseWhereMatched) {
  const Scenario scenario{.noise = NoiseMode::matched, .control = {.sigma = {0.3, 0.05}}};
  const SimulatedDrive source(find_world("web_loop"), scenario, 9);
  const Drive drive = drive_of(source, 4);
  double squares = 0.0;
  for (std::size_t k = 1; k < drive.truth.size(); ++k) {
    EXPECT_EQ(drive.controls[k][0], 3.0);
    const double dx = drive.truth[k].x - drive.truth[k - 1].x;
    const double dy = drive.truth[k].y - drive.truth[k - 1].y;
    squares += std::pow(std::hypot(dx, dy) * 40.0 - 3.0, 2);
  }
  const double n = static_cast<double>(drive.truth.size() - 1);
  EXPECT_NEAR(std::sqrt(squares / n), 0.3, 5.0 * 0.3 / std::sqrt(2.0 * n));
  EXPECT_EQ(drive.truth.size(),
            SimulatedDrive(find_world("web_loop"), Scenario{}, 9).itinerary().steps());
}

TEST(SimulatedDrive, OpenLoopControlsTellNothingOfTheTruth) {
  const auto drive_with = [](Pilot pilot, double sigma, std::uint64_t run) {
    const Scenario scenario{.noise = NoiseMode::matched,
                            .pilot = pilot,
                            .control = {.sigma = {sigma, sigma}},
                            .sigma_range = 0.0};
    return drive_of(SimulatedDrive(find_world("web_loop"), scenario, 9), run);
  };
  const Drive nominal = drive_with(Pilot::closed_loop, 0.0, 0);
  const Drive first = drive_with(Pilot::open_loop, 0.05, 0);
  const Drive second = drive_with(Pilot::open_loop, 0.05, 1);
  EXPECT_TRUE(same_controls(first, nominal));
  EXPECT_TRUE(same_controls(second, nominal));
  EXPECT_FALSE(same_controls(drive_with(Pilot::closed_loop, 0.05, 0), nominal));
  EXPECT_GT(boxminus(first.truth.back(), second.truth.back()).norm(), 0.1);
}

TEST(SimulatedDrive, TurnsWithTheWorld) {
  const double turn = 1.1;
  const Eigen::Vector2d shift(40.0, -7.0);
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(turn).toRotationMatrix();
  World world = find_world("web_loop");
  Scenario scenario{.noise = NoiseMode::matched, .control = {.sigma = {0.1, 0.01}}};
  const Drive straight = drive_of(SimulatedDrive(world, scenario, 2), 0);
  for (auto& p : world.landmarks) p = rotation * p + shift;
  for (auto& p : world.waypoints) p = rotation * p + shift;
  scenario.start = {shift.x(), shift.y(), turn};
  const Drive turned = drive_of(SimulatedDrive(world, scenario, 2), 0);
  ASSERT_EQ(turned.scan_begin, straight.scan_begin);
  for (std::size_t i = 0; i < straight.detections.size(); ++i) {
    EXPECT_NEAR(turned.detections[i][0], straight.detections[i][0], 1e-6);
    EXPECT_NEAR(wrap(turned.detections[i][1] - straight.detections[i][1]), 0.0, 1e-6);
  }
}

TEST(SimulatedDrive, CountsScansInWholeNumbers) {
  const World square{
      .name = "square", .waypoints = {{10, 0}, {10, 10}, {0, 10}, {0, 0}}, .landmarks = {{5, 5}}};
  const Scenario scenario{.loops = 400, .vehicle = Car{.wheelbase = 1.0}, .speed = 0.6};
  const SimulatedDrive source(square, scenario, 1);
  const Itinerary& itinerary = source.itinerary();
  ASSERT_GT(itinerary.steps(), 1'000'000U);
  const auto within = std::ranges::count_if(itinerary.scan_step,
                                            [](std::uint32_t step) { return step < 1'000'000U; });
  EXPECT_EQ(within, 125'000);
  EXPECT_EQ(itinerary.scan_step[0], 7U);
  EXPECT_DOUBLE_EQ(itinerary.step_time[999'999], 25'000.0);
}

TEST(SimulatedDrive, SaysWhichWaypointCannotBeReached) {
  const World tight{.name = "tight", .waypoints = {{30, 0}, {30, 2}}, .landmarks = {{5, 5}}};
  EXPECT_THAT(engine::complaint_of([&] { SimulatedDrive(tight, {.waypoint_radius = 0.1}, 1); }),
              HasSubstr("is not reached within 0.1 m"));
}

// Facts of the benchmark map.
TEST(SimulatedDrive, RepeatsThePublishedBenchmark) {
  const std::filesystem::path map = published_data("bailey/example_webmap.mat");
  if (map.empty() || !python_has("scipy")) {
    GTEST_SKIP() << "no bailey/example_webmap.mat (set MONTECARTA_DATA to the folder that holds "
                    "it), or no python3-scipy";
  }
  const ScratchFolder folder;
  const std::filesystem::path csv = folder / "webmap.csv";
  ASSERT_EQ(engine::run_program("/usr/bin/python3 -B " MONTECARTA_SOURCE_DIR
                                "/experiments/convert/world.py " +
                                map.string() + " -o " + csv.string())
                .status,
            0);
  const World world = read_world_file(csv);
  const SimulatedDrive once(world, Scenario{}, 1);
  EXPECT_EQ(once.itinerary().steps(), 8778U);
  EXPECT_EQ(once.itinerary().scans(), 1097U);
  const SeenLandmarks seen = seen_in(drive_of(once, 0));
  EXPECT_NEAR(seen.mean, 1.07, 0.005);
  EXPECT_NEAR(seen.empty_share, 0.24, 0.005);
  EXPECT_EQ(seen.different, 30U);
  const SimulatedDrive twice(world, Scenario{.loops = 2}, 1);
  EXPECT_EQ(twice.itinerary().steps(), 17381U);
  EXPECT_EQ(twice.itinerary().scans(), 2172U);
}

TEST(SimulatedDrive, SeesTheLandmarksOfTheRunsOwnMap) {
  for (const NoiseMode noise : {NoiseMode::measured_control, NoiseMode::matched}) {
    const Scenario scenario{.noise = noise,
                            .map = MapPlacement::random,
                            .map_shift = 4.0,
                            .sigma_range = 0.0,
                            .sigma_bearing = 0.0};
    const World world = find_world("web_loop");
    const SimulatedDrive source(world, scenario, 5);
    const auto landmarks = RandomMap(world.landmarks, 4.0, 5)(2);
    Drive drive;
    source.generate(1, drive);
    source.generate(2, drive);
    EXPECT_TRUE(same_numbers(drive, drive_of(source, 2)));
    EXPECT_FALSE(drive.detections.empty());
    for (std::size_t s = 0; s < source.itinerary().scans(); ++s) {
      const Pose& pose = drive.truth[source.itinerary().scan_step[s]];
      for (const Detection& seen : drive.scan(s)) {
        const Eigen::Vector2d at = landmarks[static_cast<std::size_t>(seen.identity)];
        EXPECT_NEAR(std::hypot(at.x() - pose.x, at.y() - pose.y), seen[0], 1e-9);
      }
    }
  }
}

// Uniform over a disc: the mean of the squared distance is half of its greatest, here to 5 standard
// errors (its variance is 1/12 of the greatest, squared).
TEST(RandomMap, DisplacesEvenlyOverADisc) {
  const std::vector<Eigen::Vector2d> places(100, Eigen::Vector2d(3.0, -7.0));
  const RandomMap map(places, 4.0, 5);
  double squares = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::uint64_t run = 0; run < 20; ++run) {
    for (const Eigen::Vector2d& at : map(run)) {
      EXPECT_LE((at - places[0]).norm(), 4.0);
      squares += (at - places[0]).squaredNorm();
      sum += at - places[0];
    }
  }
  const double n = 2000.0;
  EXPECT_NEAR(squares / n, 8.0, 5.0 * 16.0 / std::sqrt(12.0 * n));
  EXPECT_LT((sum / n).norm(), 5.0 * std::sqrt(8.0 / n));
}

TEST(RandomMap, DiffersFromRunToRunAndFromSeedToSeed) {
  const RandomMap map({{0, 0}}, 1.0, 5), other({{0, 0}}, 1.0, 6);
  EXPECT_EQ(map(3), map(3));
  EXPECT_NE(map(3), map(4));
  EXPECT_NE(map(3), other(3));
}

}  // namespace
}  // namespace montecarta::experiments
