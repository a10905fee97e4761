// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/log_csv.hpp"

#include "experiments/files/files.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <array>
#include <bit>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

/// Every number of a log by its bits, with the counts that tell where each part ends.
std::vector<std::uint64_t> bits_of(const DriveLog& log) {
  std::vector<std::uint64_t> bits;
  const auto add = [&bits](auto... numbers) {
    (bits.push_back(std::bit_cast<std::uint64_t>(static_cast<double>(numbers))), ...);
  };
  add(log.start.x, log.start.y, log.start.heading, log.odometry.size(), log.scans.size());
  for (const auto& [time, control] : log.odometry) add(time, control[0], control[1]);
  for (const auto& [time, detections] : log.scans) {
    add(time, detections.size());
    for (const auto& [values, identity] : detections) add(values[0], values[1], identity);
  }
  for (const auto& [name, times, positions, headings, covariances] : log.references) {
    add(times.size(), headings.size());
    for (const char c : name) add(c);
    for (const double time : times) add(time);
    for (const auto& position : positions) add(position.x(), position.y());
    for (const double heading : headings) add(heading);
    for (const auto& covariance : covariances) {
      for (const double element : covariance.reshaped()) add(element);
    }
  }
  for (const auto& landmark : log.landmarks) add(landmark.x(), landmark.y());
  return bits;
}

bool same_log(const DriveLog& a, const DriveLog& b) { return bits_of(a) == bits_of(b); }

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
  /// The complaint if one file holds `text`.
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

TEST_F(LogCsv, WritesOnlyToAnEmptyFolder) {
  EXPECT_THAT(complaint_of([this] { write_log_csv(full_log(), folder_.path()); }),
              HasSubstr("not empty"));
}

TEST_F(LogCsv, WritesNothingThatItCouldNotRead) {
  DriveLog log = full_log();
  log.odometry[1].control[1] = 2.0;
  const std::filesystem::path folder = folder_ / "far";
  EXPECT_THAT(complaint_of([&] { write_log_csv(log, folder); }),
              AllOf(HasSubstr("odometry.csv: steer 2 ("), HasSubstr("less noise")));
  log = full_log();
  log.scans[1].detections[0][0] = -0.5;
  EXPECT_THAT(complaint_of([&] { write_log_csv(log, folder); }),
              HasSubstr("detections.csv: range -0.5 ("));
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST_F(LogCsv, NamesFileAndLineOfAMistake) {
  const std::string odometry = "time_s,speed_mps,steer_rad\n";
  const std::string scans = "time_s,range_m,bearing_rad,identity\n";
  const std::vector<std::array<std::string, 3>> cases = {
      {"odometry.csv", odometry + "0.1,1\n", "odometry.csv:2: 2 fields"},
      {"odometry.csv", odometry + "0.1,nan,0\n", "odometry.csv:2: 'nan' is no speed"},
      {"odometry.csv", "time,speed,steer\n0.1,1,0\n", "odometry.csv:1"},
      {"odometry.csv", "", "odometry.csv: empty"},
      {"odometry.csv", odometry, "no rows"},
      {"odometry.csv", odometry + "1,1,0\n0.5,1,0\n", "odometry.csv:3: time 0.5 s comes after 1 s"},
      {"odometry.csv", odometry + "0.1,1,0\n0.2,1,0.1\n", "nothing"},
      {"detections.csv", scans + "0.1,5,0.2,-1\n", "is no identity"},
      {"detections.csv", scans + "0.1,5,0.2,1.5\n", "is no identity"},
      {"detections.csv", scans + "0.1,5,,1\n", "'' is no bearing"},
      {"detections.csv", scans + "0.1,,,\n0.1,5,0,1\n", "detections.csv:3"},
      {"detections.csv", scans + "0.2,5,0,1\n0.1,5,0,1\n", "rows go forward in time"},
      {"detections.csv", scans + "0.2,5,0,\n0.3,5,0,1\n", "nothing"}};
  for (const auto& [name, text, words] : cases) {
    EXPECT_THAT(complaint(name, text), HasSubstr(words)) << text;
  }
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
  EXPECT_THAT(complaint("landmarks.csv", "x_m,y_m\n"), HasSubstr("landmarks.csv: no rows"));
  std::filesystem::remove(folder_ / "landmarks.csv");
  EXPECT_THAT(complaint("landmark.csv", "x_m,y_m\n"), HasSubstr("no file of a log"));
  std::filesystem::remove(folder_ / "landmark.csv");
  EXPECT_THAT(complaint("start.csv", "time_s,x_m,y_m,heading_rad\n"), HasSubstr("no row"));
  EXPECT_THAT(complaint("start.csv", "time_s,x_m,y_m,heading_rad\n0,1,2,3\n0,4,5,6\n"),
              HasSubstr("more than one row"));
  write("start.csv", "time_s,x_m,y_m,heading_rad\n0,1,2,3\n");
  std::filesystem::remove(folder_ / "reference_gps.csv");
  EXPECT_THAT(read().references, testing::IsEmpty()) << "innovations alone are judged then";
  EXPECT_THAT(complaint_of([this] { read_log_csv(folder_ / "absent"); }), HasSubstr("cannot be"));
}

/// A file of the log and the complaint about it; "nothing" if it is allowed.
struct ChangedFile {
  std::string name, text, words;
};

/// A log with landmarks, of which every file but one is good.
class ChangedLog : public LogCsv {
 protected:
  ChangedLog() {
    write("landmarks.csv", "x_m,y_m\n1,2\n3,4\n");
    write("odometry.csv", kOdometry + "0.1,1,0\n0.3,1,0.1\n");
    write("detections.csv", kScans + "0.1,5,0.2,0\n0.2,5,0.1,1\n");
    write("reference.csv", kPoses + "0,0,0,0\n1,0,0,0\n");
  }
  void expect_complaints(const std::vector<ChangedFile>& cases) const {
    for (const auto& [name, text, words] : cases) {
      const std::string before = text_file(folder_ / name);
      EXPECT_THAT(complaint(name, text), HasSubstr(words)) << text;
      write(name, before);
    }
    EXPECT_EQ(complaint_of([this] { read(); }), "nothing");
  }
  const std::string kOdometry = "time_s,speed_mps,steer_rad\n";
  const std::string kScans = "time_s,range_m,bearing_rad,identity\n";
  const std::string kPoses = "time_s,x_m,y_m,heading_rad\n";
};

TEST_F(ChangedLog, NeedsEachPart) {
  expect_complaints({
      {"odometry.csv", kOdometry, "odometry.csv: no rows"},
      {"detections.csv", kScans, "detections.csv: no rows"},
      {"reference.csv", kPoses, "reference.csv: no rows"},
      {"detections.csv", kScans + "0.1,5,0.2,0\n5.2,,,\n", "nothing"},
      {"detections.csv", kScans + "0.1,5,0.2,0\n5.4,,,\n", "the last record is at 0.3"},
  });
  write("reference_reference.csv", kPoses + "0,0,0,0\n");
  EXPECT_THAT(complaint_of([this] { read(); }), HasSubstr("references called reference"));
  std::filesystem::remove(folder_ / "reference_reference.csv");
  write("reference_a b.csv", kPoses + "0,0,0,0\n");
  EXPECT_THAT(complaint_of([this] { read(); }), HasSubstr("is no name"));
}

TEST_F(ChangedLog, NeedsTimesThatIncrease) {
  expect_complaints({
      {"odometry.csv", kOdometry + "0.1,1,0\n0.1,1,0\n", "odometry.csv:3: equal times 0.1 s"},
      {"detections.csv", kScans + "0.1,5,0,0\n0.2,5,0,1\n0.15,5,0,1\n", "detections.csv:4: time"},
      {"reference.csv", kPoses + "0,0,0,0\n-1,0,0,0\n", "reference.csv:3: time -1 s"},
      {"odometry.csv", kOdometry + "1e12,1,0\n", "odometry.csv:2: time 1e+12 (seconds"},
      {"start.csv", kPoses + "0.15,1,2,0.5\n", "detections.csv: the first is at 0.1 s"},
      {"odometry.csv", kOdometry + "0.01,1,0\n", "odometry.csv: all of it is before the start"},
  });
}

TEST_F(ChangedLog, NeedsNumbersThatCanBe) {
  expect_complaints({
      {"odometry.csv", kOdometry + "0.1,nan,0\n", "odometry.csv:2: 'nan' is no speed"},
      {"odometry.csv", kOdometry + "0.1,1,0\n0.2,1,5\n", "odometry.csv:3: steer 5 (radians"},
      {"detections.csv", kScans + "0.1,0,0.1,0\n", "detections.csv:2: range 0 ("},
      {"detections.csv", kScans + "0.1,5,45,0\n", "detections.csv:2: bearing 45 (radians"},
      {"reference.csv", kPoses + "0,5e6,0,0\n", "reference.csv:2: coordinate 5e+06 (metres"},
      {"reference.csv", kPoses + "0,0,0,4000\n", "reference.csv:2: heading 4000 (radians"},
      {"landmarks.csv", "x_m,y_m\n1,2\n3,2e6\n", "landmarks.csv:3: coordinate 2e+06"},
      {"start.csv", kPoses + "0.1,1e7,2,0\n", "start.csv:2: coordinate 1e+07"},
      {"start.csv", kPoses + "0.1,1,2,4000\n", "start.csv:2: heading 4000"},
  });
}

TEST_F(ChangedLog, NeedsIdentitiesOnceInAScanAndOfALandmark) {
  expect_complaints({
      {"detections.csv", kScans + "0.1,5,0,1\n0.1,5,1,1\n", "detections.csv:3: identity 1 twice"},
      {"detections.csv", kScans + "0.1,5,0,\n0.1,5,1,\n", "nothing"},
      {"detections.csv", kScans + "0.1,5,0,2\n", "detections.csv:2: identity 2 of 2 landmarks"},
      {"detections.csv", kScans + "0.1,5,0,-3\n", "'-3' is no identity"},
      {"detections.csv", kScans + "0.1,5,0,1000000\n", "'1000000' is no identity"},
  });
}

const std::string kSigmas = "time_s,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m,sigma_heading_rad\n";
const std::string kCovariance = "time_s,x_m,y_m,var_x_m2,cov_x_y_m2,var_y_m2\n";
const std::string kWhole =
    "time_s,x_m,y_m,heading_rad,var_x_m2,cov_x_y_m2,var_y_m2,"
    "cov_x_heading_m_rad,cov_y_heading_m_rad,var_heading_rad2\n";

class ReferenceCsv : public testing::Test {
 protected:
  ReferencePath read(const std::string& text) const {
    write_text(folder_ / "reference.csv", text);
    return read_reference_csv(folder_ / "reference.csv", "reference");
  }
  std::string complaint(const std::string& text) const {
    return complaint_of([&] { read(text); });
  }
  ScratchFolder folder_;
};

TEST_F(ReferenceCsv, WithoutErrorsHasNoCovariance) {
  EXPECT_TRUE(read("time_s,x_m,y_m\n0,1,2\n").covariance.empty());
  const ReferencePath pose = read("time_s,x_m,y_m,heading_rad\n0,1,2,0.5\n");
  EXPECT_EQ(pose.heading.at(0), 0.5);
  EXPECT_TRUE(pose.covariance.empty());
}

TEST_F(ReferenceCsv, SquaresStandardDeviations) {
  const ReferencePath pose = read(kSigmas + "0,1,2,0.5,3,4,0.5\n1,1,2,0.5,1,1,1\n");
  EXPECT_EQ(pose.dimension(), 3);
  ASSERT_EQ(pose.covariance.size(), 2U);
  EXPECT_EQ(pose.covariance[0], Eigen::Matrix3d(Eigen::Vector3d(9, 16, 0.25).asDiagonal()));
  const ReferencePath place = read("time_s,x_m,y_m,sigma_x_m,sigma_y_m\n0,1,2,3,4\n");
  EXPECT_EQ(place.dimension(), 2);
  EXPECT_EQ(place.covariance.at(0), Eigen::Matrix3d(Eigen::Vector3d(9, 16, 0).asDiagonal()));
}

TEST_F(ReferenceCsv, ReadsACovarianceByItsLowerTriangle) {
  const Eigen::Matrix3d pose{{4, 1, 0.2}, {1, 9, 0.3}, {0.2, 0.3, 0.25}};
  EXPECT_EQ(read(kWhole + "0,1,2,0.5,4,1,9,0.2,0.3,0.25\n").covariance.at(0), pose);
  const Eigen::Matrix3d place{{4, 1, 0}, {1, 9, 0}, {0, 0, 0}};
  EXPECT_EQ(read(kCovariance + "0,1,2,4,1,9\n").covariance.at(0), place);
}

TEST_F(ReferenceCsv, ReadsBackWhatItWrote) {
  for (const ReferencePath& reference : full_log().references) {
    const ReferencePath again = read(csv_of(reference));
    EXPECT_EQ(again.covariance, reference.covariance);
    EXPECT_EQ(again.heading, reference.heading);
  }
  const std::string place = kCovariance + "0,1,2,4,1,9\n";
  EXPECT_EQ(csv_of(read(place)), place);
}

TEST_F(ReferenceCsv, RefusesErrorsThatNoFixHasAndAHeadingWithoutASigma) {
  EXPECT_THAT(complaint(kSigmas + "0,1,2,0.5,3,4,0.5\n1,1,2,0.5,3,-4,0.5\n"),
              AllOf(HasSubstr("reference.csv:3"), HasSubstr("standard deviation -4")));
  EXPECT_THAT(complaint(kSigmas + "0,1,2,0.5,3,4,12\n"), HasSubstr("12 of the heading (radians"));
  EXPECT_THAT(complaint(kSigmas + "0,1,2,0.5,3,0,0.5\n"), HasSubstr("at least 1e-9"));
  EXPECT_THAT(complaint(kSigmas + "0,1,2,0.5,3,,0.5\n"), HasSubstr("is no standard deviation"));
  EXPECT_THAT(complaint(kCovariance + "0,1,2,4,6,9\n"), HasSubstr("reference.csv:2"));
  EXPECT_THAT(complaint(kCovariance + "0,1,2,4,0,-9\n"), HasSubstr("not positive definite"));
  EXPECT_THAT(complaint(kWhole + "0,1,2,0.5,1,0.9,1,0.9,-0.9,1\n"), HasSubstr("not positive"));
  EXPECT_THAT(complaint("time_s,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m\n0,1,2,0.5,1,1\n"),
              AllOf(HasSubstr("reference.csv:1"), HasSubstr("is not the header"),
                    HasSubstr("sigma_x_m,sigma_y_m,sigma_heading_rad")));
}

TEST_F(ReferenceCsv, ErrorsBelongToTheFingerprintOfADrive) {
  DriveLog log = full_log(), other = log;
  other.references[0].covariance[1](2, 2) += 1e-12;
  EXPECT_NE(fingerprint_of(log), fingerprint_of(other));
}

}  // namespace
}  // namespace montecarta::experiments
