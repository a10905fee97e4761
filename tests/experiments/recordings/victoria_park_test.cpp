// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/published_drives.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/published_data.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// A folder with a small drive in both releases.
class VictoriaPark : public testing::Test {
 protected:
  VictoriaPark() {
    write_small_park(folder_.path());
    add_small_park_mat(folder_.path());
  }
  DriveLog read(Steering steering = Steering::calibrated) const {
    return read_victoria_park(folder_.path(), steering);
  }
  std::string complaint() const {
    return complaint_of([this] { read(); });
  }
  /// What is said where one file holds `text`.
  std::string complaint(const std::string& name, const std::string& text) const {
    write_text(folder_ / name, text);
    const std::string said = complaint();
    write_small_park(folder_.path());
    return said;
  }
  ScratchFolder folder_;
};

TEST_F(VictoriaPark, ReadsTheTextRelease) {
  const DriveLog log = read();
  ASSERT_EQ(log.odometry.size(), 3U);
  EXPECT_EQ(log.odometry[0].control[1], -0.01);
  EXPECT_EQ(log.odometry[2].time, 1.025);
  ASSERT_EQ(log.scans.size(), 2U);
  EXPECT_EQ(log.scans[1].detections.size(), 1U);
  EXPECT_NEAR(log.scans[1].detections[0][1], 0.1745, 1e-4) << "10 deg to the left";
  ASSERT_EQ(log.references.size(), 2U);
  EXPECT_EQ(log.references[0].name, "gps");
  EXPECT_EQ(log.references[0].position[1], Eigen::Vector2d(3, -2)) << "x is East, the last column";
  EXPECT_EQ(log.start.x, 0.0);
  EXPECT_NEAR(log.start.heading, 0.6196, 1e-4);
}

TEST_F(VictoriaPark, BringsTheMatReleaseToTheTextsClockAndOrigin) {
  const DriveLog log = read(Steering::raw);
  EXPECT_EQ(log.odometry[0].time, 0.975);
  EXPECT_EQ(log.odometry[0].control[1], -0.0125);
  EXPECT_EQ(log.references[1].name, "gps_all");
  EXPECT_EQ(log.references[1].time[1], 1.0);
  EXPECT_EQ(log.references[1].position[0], Eigen::Vector2d(0, 0));
  EXPECT_EQ(log.references[1].position[1], Eigen::Vector2d(3, -2));
}

TEST_F(VictoriaPark, ReadsSweepsFromEitherRelease) {
  const DriveLog text = read();
  fs::remove(folder_ / "LASER.txt");
  add_small_laser_mat(folder_.path());
  const DriveLog mat = read();
  ASSERT_EQ(mat.scans.size(), 2U);
  EXPECT_EQ(mat.scans[1].time, text.scans[1].time);
  EXPECT_EQ(mat.scans[1].detections[0][0], text.scans[1].detections[0][0]);
}

TEST_F(VictoriaPark, DoesWithOneReferenceAndWithoutTheManager) {
  fs::remove(folder_ / "Sensors_manager.txt");
  fs::remove(folder_ / "GPS.txt");
  EXPECT_EQ(read().references.at(0).name, "gps_all");
  fs::remove(folder_ / "aa3_gpsx.mat");
  EXPECT_THAT(complaint(), HasSubstr("GPS.txt: cannot be opened"));
}

TEST_F(VictoriaPark, NamesFileAndRecordOfAMistake) {
  EXPECT_THAT(complaint("DRS.txt", "1 2 0\n1.025 2\n"),
              AllOf(HasSubstr("DRS.txt: record 2: 2 of 3 numbers"), HasSubstr("a line")));
  EXPECT_THAT(complaint("DRS.txt", "1 2 0\n1.025 fast 0\n"),
              HasSubstr("DRS.txt: record 2: 'fast' is no finite number"));
  EXPECT_THAT(complaint("DRS.txt", "1 2 0\n0.5 2 0\n"),
              AllOf(HasSubstr("DRS.txt: record 2"), HasSubstr("times must increase")));
  EXPECT_THAT(complaint("DRS.txt", ""), HasSubstr("DRS.txt: no records"));
  EXPECT_THAT(complaint("GPS.txt", "0 0 0\n1 nan 2\n"), HasSubstr("GPS.txt: record 2: 'nan'"));
  std::string endless = "1 2 ";
  endless.append(1'000'000, '9').append("\n");
  EXPECT_THAT(complaint("DRS.txt", endless), HasSubstr("is no finite number"));
}

TEST_F(VictoriaPark, NamesTheScanOfAMistake) {
  Ranges ranges = sweep_of_tree(180);
  const std::string good = laser_record(0.98, ranges);
  ranges[7] = -3.0;
  EXPECT_THAT(complaint("LASER.txt", good + laser_record(1.02, ranges)),
              HasSubstr("LASER.txt: record 2: range -3 of beam 7"));
  const std::size_t middle = good.rfind('\t', good.size() / 2);
  EXPECT_THAT(complaint("LASER.txt", good + good.substr(0, middle + 1)),
              AllOf(HasSubstr("LASER.txt: record 2: "), HasSubstr("of 362 numbers")));
  EXPECT_THAT(complaint("LASER.txt", good + good.substr(0, middle)),
              HasSubstr("LASER.txt: record 2: '10' ends with the file"));
  EXPECT_THAT(complaint("LASER.txt", good + "1.02\tnan\t"),
              HasSubstr("LASER.txt: record 2: 'nan'"));
}

TEST_F(VictoriaPark, HoldsTheManagerAgainstTheFiles) {
  EXPECT_THAT(complaint("DRS.txt", "0.975 1.5 0\n1 1.5 0\n"),
              AllOf(HasSubstr("Sensors_manager.txt: record 7 (odometry)"), HasSubstr("of 2")));
  EXPECT_THAT(complaint("DRS.txt", "0.975 1.5 0\n1 1.5 0\n1.025 1 0\n1.05 1 0\n"),
              HasSubstr("3 of 4 records of odometry are listed"));
  EXPECT_THAT(complaint("GPS.txt", "0 0 0\n1.01 -2 3\n2 -4 6.5\n"), HasSubstr("record 4 (GPS)"));
  EXPECT_THAT(complaint("Sensors_manager.txt", "0 4 1\n"), HasSubstr("sensor 4"));
  EXPECT_THAT(complaint("Sensors_manager.txt", "0 1 2\n"), HasSubstr("record 2 at 0 s is not"));
}

TEST_F(VictoriaPark, RefusesMatFilesOfOtherShapes) {
  fs::remove(folder_ / "aa3_dr.mat");
  add_times(folder_ / "aa3_dr.mat", "time", {21942, 21967});
  add_doubles(folder_ / "aa3_dr.mat", "speed", {1, 2, 3}, 3);
  const auto said = [this] { return complaint_of([this] { read(Steering::raw); }); };
  EXPECT_THAT(said(), AllOf(HasSubstr("aa3_dr.mat: 'speed' has 3"), HasSubstr("of 2")));
  fs::remove(folder_ / "aa3_dr.mat");
  EXPECT_THAT(said(), HasSubstr("aa3_dr.mat: cannot be opened"));
}

struct Yield {
  std::size_t all = 0, most = 0, near = 0, empty_scans = 0;
};

Yield yield_of(const DriveLog& log) {
  Yield yield;
  for (const LoggedScan& scan : log.scans) {
    yield.all += scan.detections.size();
    yield.most = std::max(yield.most, scan.detections.size());
    yield.empty_scans += scan.detections.empty() ? 1 : 0;
    for (const Detection& tree : scan.detections) yield.near += tree[0] < 30.0 ? 1 : 0;
  }
  return yield;
}

TEST(PublishedVictoriaPark, HoldsItsCheckValues) {
  const fs::path folder = published_data("victoria_park");
  if (folder.empty())
    GTEST_SKIP() << "no victoria_park: set MONTECARTA_DATA to the folder that holds it";
  const DriveLog log = read_victoria_park(folder, Steering::calibrated);
  EXPECT_EQ(log.odometry.size(), 61763U);
  EXPECT_EQ(log.scans.size(), 7230U);
  const Yield yield = yield_of(log);
  EXPECT_EQ(yield.all, 52792U);
  EXPECT_EQ(yield.most, 18U);
  EXPECT_EQ(yield.empty_scans, 19U);
  EXPECT_NEAR(static_cast<double>(yield.near) / static_cast<double>(yield.all), 0.706, 5e-4);
}

// GPS.txt is a part of the .mat fixes, rounded to centimetres: so origin, axes and clock agree.
TEST(PublishedVictoriaPark, HasOneClockAndOneOrigin) {
  const fs::path folder = published_data("victoria_park");
  if (folder.empty())
    GTEST_SKIP() << "no victoria_park: set MONTECARTA_DATA to the folder that holds it";
  const DriveLog log = read_victoria_park(folder, Steering::raw);
  EXPECT_EQ(log.odometry.size(), 61945U);
  ASSERT_EQ(log.references.size(), 2U);
  const ReferencePath& some = log.references[0];
  const ReferencePath& all = log.references[1];
  EXPECT_EQ(some.time.size(), 948U);
  EXPECT_EQ(all.time.size(), 4466U);
  std::map<double, Eigen::Vector2d> fixes;
  for (std::size_t i = 0; i < all.time.size(); ++i) fixes[all.time[i]] = all.position[i];
  for (std::size_t i = 0; i < some.time.size(); ++i) {
    ASSERT_TRUE(fixes.contains(some.time[i])) << some.time[i];
    EXPECT_LT((fixes[some.time[i]] - some.position[i]).cwiseAbs().maxCoeff(), 0.006);
  }
}

}  // namespace
}  // namespace montecarta::experiments
