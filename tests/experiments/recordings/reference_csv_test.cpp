// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/find_recording.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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

TEST_F(ReferenceCsv, RefusesErrorsThatNoFixHas) {
  EXPECT_THAT(complaint(kSigmas + "0,1,2,0.5,3,4,0.5\n1,1,2,0.5,3,-4,0.5\n"),
              AllOf(HasSubstr("reference.csv:3"), HasSubstr("standard deviation -4"),
                    HasSubstr("leave the sigmas out")));
  EXPECT_THAT(complaint(kSigmas + "0,1,2,0.5,3,0,0.5\n"), HasSubstr("at least 1e-9"));
  EXPECT_THAT(complaint(kSigmas + "0,1,2,0.5,3,,0.5\n"), HasSubstr("is no standard deviation"));
  EXPECT_THAT(complaint(kSigmas + "0,1,2,0.5,3,4,12\n"),
              AllOf(HasSubstr("record 1"), HasSubstr("radians, at most pi")));
  EXPECT_THAT(complaint(kCovariance + "0,1,2,4,6,9\n"),
              AllOf(HasSubstr("reference.csv:2"), HasSubstr("not positive definite")));
  EXPECT_THAT(complaint(kCovariance + "0,1,2,4,0,-9\n"), HasSubstr("not positive definite"));
  EXPECT_THAT(complaint(kWhole + "0,1,2,0.5,1,0.9,1,0.9,-0.9,1\n"),
              HasSubstr("not positive definite"));
}

TEST_F(ReferenceCsv, AHeadingWithoutASigmaIsNamedWithTheHeaderThatHasIt) {
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
