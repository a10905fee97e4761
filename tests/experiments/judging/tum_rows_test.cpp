// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/tum_rows.hpp"

#include "engine/errors.hpp"
#include "experiments/judging/error_convention.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/judging/drawn_errors.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class TumRows : public testing::Test {
 protected:
  std::filesystem::path written(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::string complaint(const std::string& text) const {
    try {
      read_estimates(written("e.txt", text));
    } catch (const StudyError& error) {
      return error.what();
    }
    return "";
  }
  ScratchFolder folder_;
};

const std::string kTimestamp = "# timestamp(s) tx ty tz qx qy qz qw Pr11 ...\n";
const std::string kPose = "1.5 1 2 3 0 0 0 1";
const std::string kOpenVins = kPose + " 4 0.1 0.2 5 0.3 6 7 0.4 0.5 8 0.6 9\n";

TEST_F(TumRows, HaveTheCovariancesOfOpenVinsPositionFirst) {
  const StateRows rows = read_estimates(written("e.txt", kTimestamp + kOpenVins));
  EXPECT_EQ(rows.shape, space_shape());
  EXPECT_THAT(rows.time, ElementsAre(1.5));
  EXPECT_FALSE(rows.has_cross_terms);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(6, 6);
  P.topLeftCorner<3, 3>() = Eigen::Matrix3d{{7, 0.4, 0.5}, {0.4, 8, 0.6}, {0.5, 0.6, 9}};
  P.bottomRightCorner<3, 3>() = Eigen::Matrix3d{{4, 0.1, 0.2}, {0.1, 5, 0.3}, {0.2, 0.3, 6}};
  EXPECT_EQ(rows.covariance[0], P);
}

// Law: NEES of the rotation is that of ov_eval, e = Log(R_truth' R_mean) in the frame of the body.
TEST_F(TumRows, TurnTheRotationOfOpenVinsIntoTheMap) {
  const Eigen::Quaterniond mean = Eigen::Quaterniond(0.5, -0.3, 0.7, 0.2).normalized();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, -2) / 3.0));
  const Eigen::Quaterniond truth = mean * turn.conjugate();
  std::ostringstream line;
  line.precision(17);
  line << "1 0 0 0 " << mean.x() << " " << mean.y() << " " << mean.z() << " " << mean.w()
       << " 4 0.1 0.2 5 0.3 6 1 0 0 1 0 1\n";
  const StateRows rows = read_estimates(written("e.txt", line.str()));
  Eigen::VectorXd true_state(7);
  true_state << 0, 0, 0, truth.coeffs();
  const Eigen::VectorXd e = error_of(rows.shape, ErrorConvention::world, rows.state[0], true_state);
  const Eigen::Vector3d of_body = 0.2 * Eigen::Vector3d(1, 2, -2) / 3.0;
  const Eigen::Matrix3d Pr{{4, 0.1, 0.2}, {0.1, 5, 0.3}, {0.2, 0.3, 6}};
  EXPECT_NEAR(e.dot(rows.covariance[0].llt().solve(e)), of_body.dot(Pr.llt().solve(of_body)),
              1e-12);
}

TEST_F(TumRows, HaveCovariancesBeside) {
  const auto path = written("e.txt", "# a comment\n" + kPose + "\n");
  std::string whole = "1.5", triangle = "1.5";
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const std::string number = " " + std::to_string(1 + std::min(i, j) * 6 + std::max(i, j));
      whole += number;
      if (j >= i) triangle += number;
    }
  }
  written("e.cov", whole + "\n");
  const StateRows rows = read_estimates(path);
  EXPECT_TRUE(rows.has_cross_terms);
  EXPECT_EQ(rows.covariance[0](0, 5), 6.0);
  EXPECT_EQ(rows.covariance[0](5, 4), rows.covariance[0](4, 5));
  written("e.cov", triangle + "\n");
  EXPECT_EQ(read_estimates(path).covariance, rows.covariance);
  written("e.cov", "1.4" + whole.substr(3) + "\n");
  EXPECT_THAT(complaint(kPose + "\n"), HasSubstr("e.cov:1: time 1.4 s is not that of row 1"));
  written("e.cov", "# nothing\n");
  EXPECT_THAT(complaint(kPose + "\n"), HasSubstr("0 covariances of 1 poses"));
}

TEST_F(TumRows, AreRefusedWithFileLineAndRemedy) {
  EXPECT_THAT(complaint(kPose + "\n"),
              AllOf(HasSubstr("e.txt:1: a pose without a covariance"), HasSubstr("e.cov")));
  EXPECT_THAT(complaint(kTimestamp + kOpenVins + kPose + " 1\n"), HasSubstr("e.txt:3: 9 numbers"));
  EXPECT_THAT(complaint(kOpenVins + kOpenVins), HasSubstr(":2: time 1.5 s is not later"));
  EXPECT_THAT(complaint("1 2 nan\n"), HasSubstr(":1: 'nan' is no number"));
  EXPECT_THAT(complaint(kOpenVins.substr(0, kOpenVins.size() - 1)), HasSubstr("has no end"));
  EXPECT_THAT(complaint("1 0 0 0 0 0 0 2" + kOpenVins.substr(kPose.size())),
              HasSubstr("the quaternion has length 2"));
  EXPECT_EQ(complaint(kTimestamp), "") << "a run that gave no estimates";
  EXPECT_EQ(read_estimates(written("e.txt", kTimestamp)).time.size(), 0U);
}

TEST_F(TumRows, MayBeATruthOfPosesInSpaceAlone) {
  const auto path = written("truth.txt", kTimestamp + kPose + "\n");
  EXPECT_EQ(read_truth(path, space_shape()).state[0](1), 2.0);
  EXPECT_EQ(read_truth(written("long.txt", kOpenVins), space_shape()).time.size(), 1U);
  EXPECT_THROW(read_truth(path, plane_shape()), StudyError);
  EXPECT_FALSE(is_tum(written("t.csv", "time_s,x_m\n1,2\n")));
  EXPECT_FALSE(is_tum(written("t.csv", "")));
}

}  // namespace
}  // namespace montecarta::experiments
