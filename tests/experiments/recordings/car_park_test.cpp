// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/published_drives.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/published_data.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// What is said of the small drive with variable `name` changed.
std::string complaint_with(const char* name, const std::vector<double>& values, std::size_t rows) {
  const ScratchFolder folder;
  add_doubles(folder / "data_set.mat", "unused", {0}, 1);
  write_small_car_park(folder.path());
  mat_t* file = Mat_Open((folder / "data_set.mat").c_str(), MAT_ACC_RDWR);
  Mat_VarDelete(file, name);
  Mat_Close(file);
  add_doubles(folder / "data_set.mat", name, values, rows);
  return complaint_of([&] { read_car_park(folder.path()); });
}

TEST(CarPark, ReadsPolesAndSurvey) {
  const ScratchFolder folder;
  write_small_car_park(folder.path());
  const DriveLog log = read_car_park(folder.path());
  EXPECT_EQ(log.odometry[1].control[0], 2.1);
  EXPECT_EQ(log.odometry[1].control[1], 0.2);
  ASSERT_EQ(log.scans.size(), 2U);
  ASSERT_EQ(log.scans[0].detections.size(), 1U);
  EXPECT_NEAR(log.scans[0].detections[0][0], 10.03, 1e-12);
  EXPECT_TRUE(log.scans[1].detections.empty());
  EXPECT_EQ(log.references.at(0).name, "gps");
  EXPECT_EQ(log.start_time, 45.01);
  EXPECT_EQ(log.start.x, 5.0) << "East";
  EXPECT_EQ(log.start.y, 4.0) << "North";
  EXPECT_NEAR(log.start.heading, -2.1904, 1e-4);
  ASSERT_EQ(log.landmarks.size(), 2U);
  EXPECT_EQ(log.landmarks[1], Eigen::Vector2d(2, 20));
  fs::remove(folder / "beac_juan3.mat");
  EXPECT_TRUE(read_car_park(folder.path()).landmarks.empty());
}

TEST(CarPark, NamesFileAndRecordOfAMistake) {
  std::vector<double> ranges(2 * 361, 5.0);
  ranges[2 * 9 + 1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(complaint_with("Laser", ranges, 2),
              HasSubstr("data_set.mat: scan 2: range nan of beam 9"));
  EXPECT_THAT(complaint_with("Laser", {1, 2, 3, 4}, 2), HasSubstr("'Laser' has 2 columns"));
  EXPECT_THAT(complaint_with("Laser", std::vector<double>(3 * 361, 5.0), 3),
              HasSubstr("'Laser' and 'Intensity' differ"));
  EXPECT_THAT(complaint_with("Time_VS", {45, 45.05, 45.025}, 1),
              HasSubstr("data_set.mat: record 3: time 45.025 s comes after"));
  EXPECT_THAT(complaint_with("Velocity", {1, 2}, 1), HasSubstr("'Velocity' has 2 records of 3"));
  EXPECT_THAT(complaint_with("Velocity", {1, 2, 3, 4}, 2), HasSubstr("'Velocity' is 2 x 2"));
  EXPECT_THAT(complaint_with("Sensor", {2, 1, 3, 2, 2, 2, 1}, 1), HasSubstr("record 5 (odometry)"));
}

TEST(PublishedCarPark, HoldsItsCheckValues) {
  const fs::path folder = published_data("car_park");
  if (folder.empty())
    GTEST_SKIP() << "no car_park: set MONTECARTA_DATA to the folder that holds it";
  const DriveLog log = read_car_park(folder);
  EXPECT_EQ(log.odometry.size(), 5001U);
  EXPECT_EQ(log.scans.size(), 586U);
  EXPECT_EQ(log.references.at(0).time.size(), 626U);
  EXPECT_EQ(log.landmarks.size(), 15U);
  std::size_t poles = 0;
  for (const LoggedScan& scan : log.scans) poles += scan.detections.size();
  EXPECT_EQ(poles, 892U) << "measured here; nothing is published";
}

}  // namespace
}  // namespace montecarta::experiments
