// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/state_rows.hpp"

#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <unistd.h>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class StateFiles : public testing::Test {
 protected:
  StateFiles()
      : path_(std::filesystem::temp_directory_path() /
              ("montecarta_states_" + std::to_string(::getpid()) + ".csv")) {}
  ~StateFiles() override { std::filesystem::remove(path_); }

  const std::filesystem::path& written(const std::string& text) const {
    std::ofstream(path_) << text;
    return path_;
  }
  std::string complaint(const std::string& text) const {
    try {
      read_estimates(written(text));
    } catch (const StudyError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path path_;
};

const std::string kTriangle =
    "cov_x_x,cov_x_y,cov_y_y,cov_x_heading,cov_y_heading,cov_heading_heading";
const std::string kPoseHeader = "time_s,x_m,y_m,heading_rad," + kTriangle + "\n";
const std::string kRow = "0.5,1,2,3,11,12,22,13,23,33\n";

TEST_F(StateFiles, HaveAPoseWithOneTriangleOfItsCovariance) {
  const StateRows rows = read_estimates(written(kPoseHeader + kRow));
  EXPECT_EQ(rows.shape.kind, StateKind::pose);
  EXPECT_THAT(rows.time, ElementsAre(0.5));
  EXPECT_EQ(rows.state[0], Eigen::Vector3d(1, 2, 3));
  const Eigen::Matrix3d P{{11, 12, 13}, {12, 22, 23}, {13, 23, 33}};
  EXPECT_EQ(rows.covariance[0], P);
}

TEST_F(StateFiles, HaveColumnsInAnyOrderAndAsymmetricCovariancesAsTheyAre) {
  const StateRows rows = read_estimates(
      written("time_s,cov_1_1,cov_0_1,cov_1_0,cov_0_0,v_mps,bias\n1,22,12,21,11,5,6\n"));
  EXPECT_EQ(rows.shape.kind, StateKind::vector);
  EXPECT_THAT(rows.shape.components, ElementsAre("v", "bias"));
  EXPECT_THAT(rows.shape.units, ElementsAre("mps", "1"));
  EXPECT_EQ(rows.state[0], Eigen::Vector2d(5, 6));
  const Eigen::Matrix2d P{{11, 12}, {21, 22}};
  EXPECT_EQ(rows.covariance[0], P);
}

TEST_F(StateFiles, HavePosesInSpace) {
  std::string header = "time_s,x_m,y_m,z_m,qw,qx,qy,qz", row = "1,1,2,3,1,0,0,0";
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) {
      header += ",cov_" + std::to_string(i) + "_" + std::to_string(j);
      row += i == j ? ",1" : ",0";
    }
  }
  const StateRows rows = read_estimates(written(header + "\n" + row + "\n"));
  EXPECT_EQ(rows.shape.kind, StateKind::pose_in_space);
  Eigen::VectorXd state(7);
  state << 1, 2, 3, 0, 0, 0, 1;
  EXPECT_EQ(rows.state[0], state);
  EXPECT_EQ(rows.covariance[0], (Eigen::MatrixXd::Identity(6, 6)));
  row.replace(row.find(",1,0,0,0"), 8, ",0.9,0,0,0");
  EXPECT_THAT(complaint(header + "\n" + row + "\n"),
              HasSubstr(":2: the quaternion has length 0.9"));
}

TEST_F(StateFiles, AreRefusedWithFileLineAndRemedy) {
  const std::string file = path_.string();
  EXPECT_THAT(complaint(""), HasSubstr(file + ": empty"));
  EXPECT_EQ(complaint(kPoseHeader), "") << "a run that gave no estimates";
  EXPECT_THAT(complaint("0.5,1,2,3\n"), AllOf(HasSubstr(file + ":1: '0.5'"), HasSubstr("time_s")));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,1,2\n"), HasSubstr(":2: 3 fields"));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,nan,2,3,11,12,22,13,23,33\n"),
              AllOf(HasSubstr(":2: 'nan'"), HasSubstr("finite")));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,1,2,3,11,inf,22,13,23,33\n"), HasSubstr(":2: 'inf'"));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,1,\x01\xff,3,11,12,22,13,23,33\n"), HasSubstr(":2: '"));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,1,2,3,11,12,22,13,23,33"),
              HasSubstr(":2: the last row"));
  EXPECT_THAT(complaint(kPoseHeader + kRow + kRow), HasSubstr(":3: time 0.5 s is not later"));
  EXPECT_THAT(complaint("time_s,x_m\n1,1\n"), HasSubstr(":1: no cov_x_x"));
  EXPECT_THAT(complaint("time_s,x_m,cov_x_x,cov_1_1\n"), HasSubstr("'cov_1_1' is no element"));
  EXPECT_THAT(complaint("time_s,x_m,cov_x_x,cov_0_0\n"), HasSubstr("by name and by index"));
  EXPECT_THAT(complaint("time_s,x,y,heading\n"), HasSubstr("'x' has no unit"));
  EXPECT_THAT(complaint("time_s,x_m,y_m,heading_deg\n"), HasSubstr("is in degrees"));
  EXPECT_THAT(complaint("time_s,x_m,x_m\n"), HasSubstr("column 3 'x_m'"));
  EXPECT_THAT(complaint("time_s,x_m,qx,qy\n"), HasSubstr("a quaternion, but"));
  EXPECT_THAT(complaint("time_s,cov_x_x\n"), HasSubstr("no state"));
}

TEST_F(StateFiles, MayHaveInnovations) {
  const std::string header = "time_s,b,cov_0_0,nis,nis_dof\n";
  const StateRows rows = read_estimates(written(header + "1,2,3,4.5,2\n2,2,3,0,0\n"));
  EXPECT_EQ(rows.shape.dimension(), 1U);
  EXPECT_THAT(rows.nis, ElementsAre(4.5, 0.0));
  EXPECT_THAT(rows.nis_dof, ElementsAre(2U, 0U));
  EXPECT_THAT(complaint(header + "1,2,3,-1,2\n"), HasSubstr(":2: nis -1 with nis_dof 2"));
  EXPECT_THAT(complaint(header + "1,2,3,1,0.5\n"), HasSubstr(":2: nis 1 with nis_dof 0.5"));
  EXPECT_THAT(complaint("time_s,b,cov_0_0,nis\n"), HasSubstr("belong together"));
}

TEST_F(StateFiles, HaveTruthsAtTheTimesOfEstimatesOrBetween) {
  const StateShape shape{StateKind::vector, {"a_rad", "b_m"}, {"a", "b"}, {"rad", "m"}};
  const StateRows truth =
      read_truth(written("time_s,other,b_m,a_rad\n0,9,0,3\n1,9,10,-3\n"), shape);
  const auto at = [&](double time, const TimeMatch& match) {
    return truth_at(truth, time, match, "est.csv", "truth.csv");
  };
  EXPECT_EQ(at(1.0 + 1e-7, {}), Eigen::Vector2d(-3, 10));
  EXPECT_EQ(at(0.1, {.tolerance = 0.2}), Eigen::Vector2d(3, 0));
  const Eigen::VectorXd half = at(0.5, {.interpolate = true});
  EXPECT_NEAR(std::abs(half(0)), kPi, 1e-12);
  EXPECT_EQ(half(1), 5.0);
  const auto refused = [&](double time, const TimeMatch& match) -> std::string {
    try {
      at(time, match);
    } catch (const StudyError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refused(0.25, {}),
              AllOf(HasSubstr("est.csv: time 0.25 s has no truth in truth.csv"),
                    HasSubstr("0.25 s away"), HasSubstr("--interpolate, or a larger --tolerance")));
  EXPECT_THAT(refused(1.5, {.interpolate = true}), HasSubstr("outside of the truth"));
  EXPECT_THROW(read_truth(written("time_s,b_m\n0,1\n"), shape), StudyError);
}

}  // namespace
}  // namespace montecarta::experiments
