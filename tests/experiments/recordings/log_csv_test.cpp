// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/log_csv.hpp"

#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/same_log.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A folder with a small good log.
class LogCsv : public testing::Test {
 protected:
  LogCsv() {
    write("start.csv", "time_s,x_m,y_m,heading_rad\n0.1,1,2,0.5 # by the gate\n");
    write("odometry.csv", "time_s, speed_mps, steer_rad\n# slow\n0.1,1,0\n\n0.2,1,0.1\n");
    write("detections.csv", "time_s,range_m,bearing_rad\n0.1,5,0.2\n0.1,6,-0.2\n0.2,,\n");
    write("reference_gps.csv", "time_s,x_m,y_m\n0,0,0\n1,2,3\n");
  }
  void write(const std::string& name, const std::string& text) const {
    write_text(folder_ / name, text);
  }
  DriveLog read() const { return read_log_csv(folder_.path()); }
  /// What is said where one file holds `text`.
  std::string complaint(const std::string& name, const std::string& text) const {
    write(name, text);
    return complaint_of([this] { read(); });
  }
  ScratchFolder folder_;
};

TEST_F(LogCsv, ReadsRowsOfOneTimeAsOneScan) {
  const DriveLog log = read();
  EXPECT_EQ(log.start_time, 0.1);
  EXPECT_EQ(log.start.heading, 0.5);
  EXPECT_EQ(log.odometry[1].control[1], 0.1);
  ASSERT_EQ(log.scans.size(), 2U);
  EXPECT_EQ(log.scans[0].detections.size(), 2U);
  EXPECT_EQ(log.scans[0].detections[0].identity, Detection::kUnidentified);
  EXPECT_TRUE(log.scans[1].detections.empty());
  EXPECT_EQ(log.references[0].name, "gps");
  EXPECT_TRUE(log.landmarks.empty());
}

TEST_F(LogCsv, PutsTheLeadingReferenceFirstAndLandmarksByIdentity) {
  write("reference.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0.1\n");
  write("reference_a.csv", "time_s,x_m,y_m\n0,0,0\n");
  write("landmarks.csv", "x_m,y_m,identity\n1,2,1\n3,4,0\n");
  const DriveLog log = read();
  EXPECT_EQ(log.references[0].name, "reference");
  EXPECT_EQ(log.references[1].name, "a");
  EXPECT_EQ(log.references[2].name, "gps");
  EXPECT_EQ(log.landmarks[0], Eigen::Vector2d(3, 4));
}

TEST_F(LogCsv, ReadsBackWhatItWroteBitForBit) {
  const ScratchFolder other;
  DriveLog log = full_log();
  write_log_csv(log, other / "full");
  EXPECT_TRUE(same_log(read_log_csv(other / "full"), log));
  log.landmarks.clear();
  log.references.pop_back();
  for (LoggedScan& scan : log.scans) {
    for (Detection& detection : scan.detections) detection.identity = Detection::kUnidentified;
  }
  write_log_csv(log, other / "plain");
  EXPECT_TRUE(same_log(read_log_csv(other / "plain"), log));
  EXPECT_FALSE(same_log(read_log_csv(other / "full"), log)) << "the comparison sees differences";
}

TEST_F(LogCsv, WritesOnlyToAnEmptyFolderAndOnlyWhatReadsBackTheSame) {
  EXPECT_THAT(complaint_of([this] { write_log_csv(full_log(), folder_.path()); }),
              HasSubstr("not empty"));
  DriveLog swapped = full_log();
  std::swap(swapped.references[0], swapped.references[1]);
  EXPECT_THAT(complaint_of([&] { write_log_csv(swapped, folder_ / "new"); }),
              HasSubstr("not in the order of their names"));
}

TEST_F(LogCsv, NamesFileAndLineOfAMistake) {
  EXPECT_THAT(complaint("odometry.csv", "time_s,speed_mps,steer_rad\n0.1,1\n"),
              AllOf(HasSubstr("odometry.csv:2"), HasSubstr("2 fields")));
  EXPECT_THAT(complaint("odometry.csv", "time_s,speed_mps,steer_rad\n0.1,nan,0\n"),
              AllOf(HasSubstr("odometry.csv:2"), HasSubstr("'nan' is no speed")));
  EXPECT_THAT(complaint("odometry.csv", "time,speed,steer\n0.1,1,0\n"),
              AllOf(HasSubstr("odometry.csv:1"), HasSubstr("begin with time_s,speed_mps")));
  EXPECT_THAT(complaint("odometry.csv", ""), HasSubstr("odometry.csv: empty"));
  EXPECT_THAT(complaint("odometry.csv", "time_s,speed_mps,steer_rad\n"), HasSubstr("no records"));
  EXPECT_THAT(complaint("odometry.csv", "time_s,speed_mps,steer_rad\n1,1,0\n0.5,1,0\n"),
              AllOf(HasSubstr("odometry.csv: record 2"), HasSubstr("times must increase")));
}

TEST_F(LogCsv, NamesMistakesOfScans) {
  const std::string head = "time_s,range_m,bearing_rad,identity\n";
  EXPECT_THAT(complaint("detections.csv", head + "0.1,5,0.2,-1\n"), HasSubstr("is no identity"));
  EXPECT_THAT(complaint("detections.csv", head + "0.1,5,0.2,1.5\n"), HasSubstr("is no identity"));
  EXPECT_THAT(complaint("detections.csv", head + "0.1,5,,1\n"), HasSubstr("'' is no bearing"));
  EXPECT_THAT(complaint("detections.csv", head + "0.1,,,\n0.1,5,0,1\n"),
              AllOf(HasSubstr("detections.csv:3"), HasSubstr("saw nothing has other rows")));
  EXPECT_THAT(complaint("detections.csv", head + "0.2,5,0,1\n0.1,5,0,1\n"),
              HasSubstr("times must increase"));
  EXPECT_EQ(complaint("detections.csv", head + "0.2,5,0,\n0.3,5,0,1\n"), "nothing");
  EXPECT_EQ(read().scans[0].detections[0].identity, Detection::kClutter);
}

TEST_F(LogCsv, RefusesAFileThatWasCutShortInItsLastRow) {
  const std::string whole = "time_s,speed_mps,steer_rad\n0.1,1,0\n0.2,1,0.15\n";
  for (std::size_t length = 1; length < whole.size(); ++length) {
    const bool at_a_row = whole[length - 1] == '\n' && length > 30;
    if (at_a_row) continue;  // whole rows that nothing tells apart from a shorter drive
    EXPECT_NE(complaint("odometry.csv", whole.substr(0, length)), "nothing") << length;
  }
  EXPECT_EQ(complaint("odometry.csv", whole), "nothing");
}

TEST_F(LogCsv, NamesMistakesOfOtherFiles) {
  EXPECT_THAT(complaint("landmarks.csv", "x_m,y_m,identity\n1,2,0\n3,4,2\n"),
              HasSubstr("no landmark of identity 1"));
  EXPECT_THAT(complaint("landmarks.csv", "x_m,y_m\n"), HasSubstr("no landmarks"));
  std::filesystem::remove(folder_ / "landmarks.csv");
  EXPECT_THAT(complaint("landmark.csv", "x_m,y_m\n"), HasSubstr("no file of a log"));
  std::filesystem::remove(folder_ / "landmark.csv");
  EXPECT_THAT(complaint("start.csv", "time_s,x_m,y_m,heading_rad\n"), HasSubstr("no row"));
  EXPECT_THAT(complaint("start.csv", "time_s,x_m,y_m,heading_rad\n0,1,2,3\n0,4,5,6\n"),
              HasSubstr("more than one row"));
  write("start.csv", "time_s,x_m,y_m,heading_rad\n0,1,2,3\n");
  std::filesystem::remove(folder_ / "reference_gps.csv");
  EXPECT_THAT(complaint_of([this] { read(); }), HasSubstr("no reference"));
  EXPECT_THAT(complaint_of([this] { read_log_csv(folder_ / "absent"); }),
              HasSubstr("cannot be opened"));
}

}  // namespace
}  // namespace montecarta::experiments
