// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/recorded_drive.hpp"

#include "tests/doubles/matchers.hpp"

namespace montecarta::experiments {
namespace {

std::vector<Detection> one_at(double range) { return {{range, 0.1, Detection::kUnidentified}}; }

/// Odometry at 10, 10.1 and 10.2 s, scans before, with and between.
DriveLog small_log() {
  DriveLog log;
  log.start_time = 9.9;
  log.start = {1.0, 2.0, 0.5};
  log.odometry = {{10.0, {1.0, 0.1}}, {10.1, {2.0, 0.2}}, {10.2, {3.0, 0.3}}};
  log.scans = {{9.9, one_at(5.0)}, {10.1, one_at(40.0)}, {10.15, one_at(7.0)}, {10.3, {}}};
  log.references = {{"gps", {10.0, 10.2}, {{0.0, 0.0}, {1.0, 0.0}}, {}}};
  return log;
}

std::vector<double> speeds(const Drive& drive) {
  std::vector<double> speeds;
  for (const Control& control : drive.controls) speeds.push_back(control[0]);
  return speeds;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-12) << i;
}

TEST(RecordedDrive, EndsAStepWhereverOdometryOrAScanComesIn) {
  const RecordedDrive drive(small_log(), {30.0});
  const Itinerary& itinerary = drive.itinerary();
  expect_near(itinerary.step_time, {0.0, 0.1, 0.2, 0.25, 0.3, 0.4});
  EXPECT_THAT(itinerary.scan_step, ElementsAre(0, 2, 3, 5));
  expect_near(itinerary.references[0].time, {0.1, 0.3});
  EXPECT_FALSE(itinerary.has_truth);
  EXPECT_EQ(itinerary.start.heading, 0.5);
}

TEST(RecordedDrive, DrivesByTheOdometryThatCameInLastAndStandsBeforeTheFirst) {
  Drive drive;
  RecordedDrive(small_log(), {30.0}).generate(0, drive);
  EXPECT_THAT(speeds(drive), ElementsAre(0.0, 0.0, 1.0, 2.0, 2.0, 3.0));
  EXPECT_TRUE(drive.truth.empty());
}

TEST(RecordedDrive, LeavesOutWhatIsTooFarAndKeepsTheScan) {
  Drive drive;
  RecordedDrive(small_log(), {30.0}).generate(0, drive);
  EXPECT_THAT(drive.scan_begin, ElementsAre(0, 1, 1, 2, 2));
  EXPECT_EQ(drive.scan(2)[0][0], 7.0);
}

TEST(RecordedDrive, AllRunsAreTheSameWhateverTheBufferHeld) {
  const RecordedDrive source(small_log(), {30.0});
  Drive first, second;
  second.truth.resize(3);
  source.generate(0, first);
  source.generate(17, second);
  EXPECT_EQ(speeds(first), speeds(second));
  EXPECT_EQ(first.scan_begin, second.scan_begin);
  EXPECT_TRUE(second.truth.empty());
}

TEST(RecordedDrive, BeginsAtTheStartWithTheOdometryThatHoldsThen) {
  DriveLog log = small_log();
  log.start_time = 10.05;
  log.scans.erase(log.scans.begin());
  const RecordedDrive source(log, {30.0});
  Drive drive;
  source.generate(0, drive);
  expect_near(source.itinerary().step_time, {0.05, 0.1, 0.15, 0.25});
  EXPECT_THAT(source.itinerary().scan_step, ElementsAre(0, 1, 3));
  EXPECT_THAT(speeds(drive), ElementsAre(1.0, 2.0, 2.0, 3.0));
}

TEST(RecordedDrive, TakesScansAsMuchEarlierAsTheyWereLate) {
  const RecordedDrive drive(small_log(), {30.0}, 0.05);
  const Itinerary& itinerary = drive.itinerary();
  expect_near(itinerary.step_time, {0.0, 0.1, 0.15, 0.2, 0.3, 0.35});
  EXPECT_THAT(itinerary.scan_step, ElementsAre(0, 2, 3, 5));
}

TEST(FingerprintOfALog, ChangesWithEveryNumberOfIt) {
  const std::string original = fingerprint_of(small_log());
  EXPECT_EQ(fingerprint_of(small_log()), original);
  const auto changed = [&](auto change) {
    DriveLog log = small_log();
    change(log);
    return fingerprint_of(log) != original;
  };
  EXPECT_TRUE(changed([](DriveLog& log) { log.start.x += 1e-9; }));
  EXPECT_TRUE(changed([](DriveLog& log) { log.start_time = 9.0; }));
  EXPECT_TRUE(changed([](DriveLog& log) { log.odometry[1].control[1] = 0.0; }));
  EXPECT_TRUE(changed([](DriveLog& log) { log.scans[0].detections[0].identity = 3; }));
  EXPECT_TRUE(changed([](DriveLog& log) { log.scans[3].detections = one_at(1.0); }));
  EXPECT_TRUE(changed([](DriveLog& log) { log.references[0].name = "gpt"; }));
  EXPECT_TRUE(changed([](DriveLog& log) { log.references[0].heading = {0.0, 0.0}; }));
  EXPECT_TRUE(changed([](DriveLog& log) { log.landmarks.emplace_back(1.0, 1.0); }));
}

}  // namespace
}  // namespace montecarta::experiments
