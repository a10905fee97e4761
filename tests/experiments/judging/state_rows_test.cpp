// SPDX-License-Identifier: BSD-3-Clause
#include "engine/numbers/angle.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/judging/innovation_rows.hpp"
#include "experiments/judging/read_rows.hpp"
#include "experiments/judging/truth_path.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <cmath>
#include <fstream>

namespace montecarta::experiments {
namespace {

class StateFiles : public testing::Test {
 protected:
  const std::filesystem::path& written(const std::string& text) const {
    std::ofstream(path_) << text;
    return path_;
  }
  std::string complaint(const std::string& text) const {
    return complaint_of([&] { read_estimates(written(text)); });
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "states.csv";
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
  EXPECT_THAT(complaint(header + "\n" + row + "\n"), HasSubstr(":2: the quaternion has length"));
}

TEST_F(StateFiles, AreRefusedWithFileLineAndRemedy) {
  const std::string file = path_.string();
  EXPECT_THAT(complaint(""), HasSubstr(file + ": empty"));
  EXPECT_EQ(complaint(kPoseHeader), "nothing") << "a run that gave no estimates";
  EXPECT_THAT(complaint("0.5,1,2,3\n"), AllOf(HasSubstr(file + ":1: '0.5'"), HasSubstr("time_s")));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,1,2\n"), HasSubstr(":2: 3 fields"));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,nan,2,3,11,12,22,13,23,33\n"),
              AllOf(HasSubstr(":2: 'nan'"), HasSubstr("leave out rows")));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,,2,3,11,12,22,13,23,33\n"), HasSubstr("leave out rows"));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,1,2,3,11,inf,22,13,23,33\n"), HasSubstr(":2: 'inf'"));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,1,\x01\xff,3,11,12,22,13,23,33\n"), HasSubstr(":2: '"));
  EXPECT_THAT(complaint(kPoseHeader + "0.5,1,2,3,11,12,22,13,23,33"), HasSubstr(":2: the last"));
  EXPECT_THAT(complaint(kPoseHeader + kRow + kRow), HasSubstr(":3: equal times 0.5 s"));
  EXPECT_THAT(complaint("time_s,x_m\n1,1\n"), HasSubstr(":1: no cov_x_x"));
  EXPECT_THAT(complaint("time_s,x_m,cov_x_x,cov_1_1\n"), HasSubstr("'cov_1_1' is no element"));
  EXPECT_THAT(complaint("time_s,x_m,cov_x_x,cov_0_0\n"), HasSubstr("by name and by index"));
  EXPECT_THAT(complaint("time_s,x,y,heading\n"), HasSubstr("'x' has no unit"));
  EXPECT_THAT(complaint("time_s,x_m,y_m,heading_deg\n"), HasSubstr("is in degrees"));
  EXPECT_THAT(complaint("time_s,x_m,x_m\n"), HasSubstr("column 3 'x_m'"));
  EXPECT_THAT(complaint("time_s,x_m,qx,qy\n"), HasSubstr("a quaternion, but"));
  EXPECT_THAT(complaint("time_s,cov_x_x\n"), HasSubstr("no state"));
}

TEST_F(StateFiles, NameTheElementThatIsMissingAsTheFileNamesElements) {
  EXPECT_THAT(complaint("time_s,a,b,cov_0_0,cov_0_1\n"),
              AllOf(HasSubstr("no cov_1_1"), HasSubstr("the components a,b;")));
  EXPECT_THAT(complaint("time_s,a,b,cov_a_a,cov_a_b\n"), HasSubstr("no cov_b_b"));
  EXPECT_THAT(complaint("time_s,a,b,cov_0_0,cov_0_1,cov_11\n"),
              AllOf(HasSubstr("'cov_11' is no element"), HasSubstr("is called cov_1_1")));
  EXPECT_THAT(complaint("time_s,a,b,c,cov_0_0,cov_0_1,cov_1_1,cov_1_2,cov_2_2\n"),
              HasSubstr("no cov_0_2"))
      << "a triangle with a hole";
}

TEST_F(StateFiles, MayHaveBlocksOrDeviationsAlone) {
  const StateRows whole = read_estimates(written(kPoseHeader + kRow));
  EXPECT_EQ(whole.uncorrelated, "");
  const StateRows blocks = read_estimates(
      written("time_s,a,b,c,cov_a_a,cov_a_c,cov_b_b,cov_c_c\n1,0,0,0,11,13,22,33\n"));
  const Eigen::Matrix3d P{{11, 0, 13}, {0, 22, 0}, {13, 0, 33}};
  EXPECT_EQ(blocks.covariance[0], P);
  EXPECT_EQ(blocks.uncorrelated, "between a,c and b");
  const StateRows sigmas = read_estimates(
      written("time_s,x_m,y_m,yaw_rad,sigma_yaw_rad,sigma_x_m,sigma_y_m\n1,0,0,0,3,1,-2\n"));
  EXPECT_EQ(sigmas.shape.kind, StateKind::pose);
  EXPECT_EQ(sigmas.covariance[0].diagonal(), Eigen::Vector3d(1, -4, 9)) << "a mark stays one";
  EXPECT_EQ(sigmas.uncorrelated, "between x and y and heading");
  EXPECT_THAT(complaint("time_s,a_m,b_m,sigma_a_m\n"), HasSubstr("no sigma_b"));
  EXPECT_THAT(complaint("time_s,a_m,sigma_a_rad\n"), HasSubstr("rename it to sigma_a_m"));
  EXPECT_THAT(complaint("time_s,a_m,sigma_a_m,cov_a_a\n"), HasSubstr("beside columns of a cov"));
}

// Digits were lost, or there are two estimates of one time.
TEST_F(StateFiles, WithEqualTimesAreRefusedOrReadByARule) {
  const std::string header = "time_s,x_m,cov_0_0\n";
  const auto text = [&](const std::string& a, const std::string& b) {
    return header + a + ",1,1\n" + a + ",2,2\n" + b + ",3,3\n";
  };
  EXPECT_THAT(complaint(text("1.403637e+09", "1.4037e+09")),
              AllOf(HasSubstr(":3: equal times 1.403637e+09 s"), HasSubstr("7 digits"),
                    HasSubstr("15 digits"), HasSubstr("--keep last"), Not(HasSubstr("sort"))));
  EXPECT_THAT(complaint(text("1604644894.000", "1604644895.0")), HasSubstr("whole seconds"));
  EXPECT_THAT(complaint(text("0.25", "0.5")), Not(HasSubstr("digits are printed")));
  written(text("0.25", "0.5"));
  const StateRows last = read_estimates(path_, EqualTimes::keep_last);
  EXPECT_THAT(last.time, ElementsAre(0.25, 0.5));
  EXPECT_THAT(last.line, ElementsAre(3U, 4U));
  EXPECT_EQ(last.state[0](0), 2.0);
  EXPECT_EQ(last.left_out, 1U);
  EXPECT_THAT(times_in(path_, EqualTimes::keep_last), ElementsAre(0.25, 0.5));
  const StateRows first = read_estimates(path_, EqualTimes::keep_first);
  EXPECT_EQ(first.state[0](0), 1.0);
  EXPECT_EQ(first.covariance[0](0, 0), 1.0);
  EXPECT_EQ(read_truth(path_, first.shape, {.equal = EqualTimes::keep_last}).state[0](0), 2.0);
  EXPECT_THROW(read_truth(path_, first.shape), StudyError);
}

TEST_F(StateFiles, MayCallTheHeadingByAnotherName) {
  for (const std::string name : {"yaw", "theta", "psi", "phi"}) {
    const std::string triangle = ",cov_x_x,cov_x_y,cov_y_y,cov_x_" + name + ",cov_y_" + name +
                                 ",cov_" + name + "_" + name + "\n";
    const StateRows rows = read_estimates(
        written("time_s,x_m," + name + "_rad,y_m" + triangle + "0.5,1,3,2,11,12,22,13,23,33\n"));
    EXPECT_EQ(rows.shape, read_estimates(written(kPoseHeader + kRow)).shape);
    EXPECT_EQ(rows.state[0], Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(rows.covariance[0](2, 1), 23.0);
    const std::string other = name == "yaw" ? "heading" : "yaw";
    const StateRows truth =
        read_truth(written("time_s,x_m,y_m," + other + "_rad\n0.5,1,2,3\n"), rows.shape);
    EXPECT_EQ(truth.state[0], Eigen::Vector3d(1, 2, 3));
  }
  EXPECT_THAT(likeness_to_pose(read_estimates(written("time_s,x_m,alpha_rad,y_m,cov_0_0,cov_0_1,"
                                                      "cov_0_2,cov_1_1,cov_1_2,cov_2_2\n"))
                                   .shape),
              HasSubstr("rename alpha_rad to heading_rad"));
  EXPECT_EQ(likeness_to_pose({StateKind::vector, {"a_m", "b_rad"}, {"a", "b"}, {"m", "rad"}}), "");
}

TEST_F(StateFiles, InOtherUnitsAreRefused) {
  EXPECT_THAT(complaint("time_s,x_m,y_m,yaw_degrees\n"), HasSubstr("is in degrees"));
  EXPECT_THAT(complaint("time_s,x_m,y_m,yaw_radians\n"), HasSubstr("rename it to yaw_rad"));
  EXPECT_THAT(complaint("time_s,x_meters,y_m\n"), HasSubstr("rename it to x_m"));
  EXPECT_THAT(complaint("time_s,x_cm,y_cm,heading_rad\n"), HasSubstr("is in cm"));
  EXPECT_THAT(complaint("time_ns,x_m\n"),
              AllOf(HasSubstr("divide it by 1e9"), HasSubstr("time_s")));
  EXPECT_THAT(complaint("t,x_m\n"), HasSubstr("name the column time_s"));
}

TEST_F(StateFiles, WithOtherSeparatorsAreNamed) {
  EXPECT_THAT(complaint("time_s;x_m;cov_0_0\n0,5;1;1\n"),
              AllOf(HasSubstr(":1: semicolons"), HasSubstr("decimal points")));
  EXPECT_THAT(complaint("time_s\tx_m\tcov_0_0\n"), HasSubstr(":1: tabs"));
  EXPECT_THAT(complaint("time_s x_m cov_0_0\n"), HasSubstr(":1: blanks"));
  EXPECT_THAT(complaint("time_s|x_m|cov_0_0\n"), HasSubstr(":1: vertical bars"));
  EXPECT_THAT(complaint("\"time_s\",\"x_m\"\n"), HasSubstr(":1: names in quotes"));
  const std::string header = "time_s,x_m,cov_0_0\n";
  EXPECT_THAT(complaint(header + "0.5;1;1\n"), HasSubstr(":2: semicolons"));
  EXPECT_THAT(complaint(header + "\"0,5\",\"1,5\",\"1\"\n"), HasSubstr(":2: numbers in quotes"));
  EXPECT_THAT(complaint(header + "0,5,1,5,1\n"), HasSubstr(":2: decimal commas"));
  EXPECT_THAT(complaint(header + "0.5,1.5,1.0,2\n"), HasSubstr(":2: 4 fields"));
  EXPECT_THAT(complaint(header + "\"0.5\",1,1\n"), HasSubstr("remove the quotes"));
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
  const StateRows rows = read_truth(written("time_s,other,b_m,a_rad\n0,9,0,3\n1,9,10,-3\n"), shape);
  TruthUse use;
  const auto at = [&](const std::vector<double>& times, const TimeMatch& match) {
    return TruthPath(rows, "truth.csv", match).at({.shape = shape, .time = times}, "est.csv", use);
  };
  EXPECT_EQ(at({1.0 + 1e-7}, {})[0]->state, Eigen::Vector2d(-3, 10));
  EXPECT_THAT(use.notes(false), IsEmpty());
  EXPECT_EQ(at({0.1}, {.tolerance = 0.2})[0]->state, Eigen::Vector2d(3, 0));
  EXPECT_THAT(use.notes(false),
              ElementsAre(HasSubstr("up to 0.1 s beside their estimates (est.csv")));
  const auto half = at({0.5}, {.interpolate = true})[0].value().state;
  EXPECT_NEAR(std::abs(half(0)), kPi, 1e-12);
  EXPECT_EQ(half(1), 5.0);
  EXPECT_THAT(complaint_of([&] { at({0.25}, {}); }),
              HasSubstr("est.csv: time 0.25 s has no truth"));
  EXPECT_THAT(complaint_of([&] {
                at({0.9, 1.1}, {.tolerance = 0.2});
              }),
              HasSubstr("time 1.1 s and the time before have the same row of the truth"));
  EXPECT_THROW(read_truth(written("time_s,b_m\n0,1\n"), shape), StudyError);
}

// A circle of 10 m with 3 m/s, of which rows at distance h lie v^2 h^2 / (8 r) from the chord.
TEST_F(StateFiles, HaveNoStraightTruthWhereItBends) {
  const StateShape shape{
      StateKind::pose, {"x_m", "y_m", "heading_rad"}, {"x", "y", "heading"}, {"m", "m", "rad"}};
  const auto notes_at = [&](double spacing) {
    StateRows truth{.shape = shape}, rows{.shape = shape};
    for (int k = 0; k < 20; ++k) {
      const double angle = 0.3 * spacing * k;
      truth.time.push_back(spacing * k);
      truth.state.emplace_back(Eigen::Vector3d(10 * std::cos(angle), 10 * std::sin(angle), 0));
      rows.time.push_back(spacing * (k + 0.5));
      rows.covariance.emplace_back(0.01 * Eigen::Matrix3d::Identity());
    }
    TruthUse use;
    TruthPath(truth, "truth.csv", {.interpolate = true}).at(rows, "est.csv", use);
    use.outside = 0;
    return joined(use.notes(false), "\n");
  };
  EXPECT_THAT(notes_at(1.0), HasSubstr("bends by 0.11"));
  EXPECT_EQ(notes_at(0.2), "");
}

TEST_F(StateFiles, HaveNoTruthInAGapNorOutsideOfIt) {
  const StateShape shape{StateKind::vector, {"b_m"}, {"b"}, {"m"}};
  std::string text = "time_s,b_m\n";
  for (const int time : {0, 1, 2, 3, 30, 31, 32}) text += std::to_string(time) + ",0\n";
  const StateRows rows = read_truth(written(text), shape);
  const auto known = [&](const TimeMatch& match, TruthUse& use) {
    const std::vector<double> times = {0.5, 3.0, 3.5, 29.0, 31.5, 33.0};
    std::vector<int> found;
    for (const auto& one :
         TruthPath(rows, "truth.csv", match).at({.shape = shape, .time = times}, "est.csv", use)) {
      found.push_back(one ? 1 : 0);
    }
    return found;
  };
  TruthUse use, longer;
  EXPECT_THAT(known({.interpolate = true}, use), ElementsAre(1, 1, 0, 0, 1, 0));
  EXPECT_THAT(use.notes(false),
              ElementsAre(HasSubstr("2 estimates lie in gaps of the truth and are missing "
                                    "(truth.csv has no row from 3 to 30 s)"),
                          HasSubstr("1 estimates lie before or after the truth")));
  EXPECT_THAT(known({.interpolate = true, .longest_gap = 27.0}, longer),
              ElementsAre(1, 1, 1, 1, 1, 0));
  const std::vector<double> later = {40.0, 41.0};
  EXPECT_THAT(complaint_of([&] {
                TruthPath(rows, "truth.csv", {.interpolate = true})
                    .at({.shape = shape, .time = later}, "est.csv", use);
              }),
              HasSubstr("no estimate has a truth in truth.csv (40 to 41 s here, 0 to 32 s there)"));
  EXPECT_THAT(
      complaint_of([&] {
        TruthPath(rows, "truth.csv", {}).at({.shape = shape, .time = later}, "est.csv", use);
      }),
      HasSubstr("give both the same clock"));
}

class InnovationFiles : public testing::Test {
 protected:
  StateRows read(const std::string& text, double tolerance = 1e-6) const {
    StateRows rows;
    rows.time = {1.0, 2.0, 3.0};
    std::ofstream(folder_ / "innovation.csv") << text;
    read_innovations(folder_ / "innovation.csv", "estimate.csv", tolerance, rows);
    return rows;
  }
  std::string complaint(const std::string& text) const {
    return complaint_of([&] { read(text); });
  }
  ScratchFolder folder_;
};

TEST_F(InnovationFiles, HaveNisOfTimesThatAddUp) {
  const StateRows rows = read("time_s,nis,nis_dof\n1,2.5,2\n1,1.5,2\n3,4,1\n");
  EXPECT_THAT(rows.nis, ElementsAre(4.0, 0.0, 4.0));
  EXPECT_THAT(rows.nis_dof, ElementsAre(4U, 0U, 1U));
}

TEST_F(InnovationFiles, HaveInnovationsAndTheirCovariance) {
  const StateRows rows = read(
      "time_s,range_m,bearing_rad,cov_0_0,cov_0_1,cov_1_1\n2.2,2,0.1,4,0,0.01\n"
      "3,1,1,1,2,1\n",
      0.3);
  EXPECT_NEAR(rows.nis[1], 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(rows.nis[2])) << "that is no covariance";
  EXPECT_THAT(rows.nis_dof, ElementsAre(0U, 2U, 2U));
}

TEST_F(InnovationFiles, CountAnglesBeyondPi) {
  const std::string header = "time_s,range_m,bearing_rad,cov_0_0,cov_0_1,cov_1_1\n";
  const StateRows wrapped = read(header + "1,9,3.14159265,1,0,1\n2,9,-3,1,0,1\n");
  EXPECT_EQ(wrapped.unwrapped_innovations, 0U) << "a range may be 9";
  const StateRows rows = read(header + "1,0,3,1,0,1\n2,0,6.25,1,0,1\n3,0,-3.5,1,0,1\n");
  EXPECT_EQ(rows.unwrapped_innovations, 2U);
  EXPECT_THAT(rows.first_unwrapped, HasSubstr("innovation.csv:3: bearing_rad 6.25"));
  EXPECT_NEAR(rows.nis[1], 6.25 * 6.25, 1e-12) << "they are used as they are";
}

TEST_F(InnovationFiles, AreRefusedWithFileLineAndRemedy) {
  const std::string header = "time_s,nis,nis_dof\n";
  EXPECT_THAT(complaint(header + "1.5,1,1\n"), HasSubstr("innovation.csv:2: no estimate in"));
  EXPECT_THAT(complaint(header + "2,1,1\n1,1,1\n"), HasSubstr(":3: time 1 s comes after 2 s"));
  EXPECT_THAT(complaint(header + "2,-1,1\n"), HasSubstr(":2: nis -1 with nis_dof 1"));
  EXPECT_THAT(complaint("time_s,nis\n1,1\n"), HasSubstr("write time_s,nis,nis_dof"));
  EXPECT_THAT(complaint("time_s,a_m\n1,1\n"), HasSubstr("no cov_a_a"));
}

TEST_F(InnovationFiles, LieBesideTheirEstimates) {
  std::ofstream(folder_ / "innovation_ekf.csv") << "time_s,nis,nis_dof\n";
  EXPECT_EQ(innovations_beside(folder_ / "estimate_ekf.csv"), folder_ / "innovation_ekf.csv");
  EXPECT_EQ(innovations_beside(folder_ / "estimate_ekf.txt"), folder_ / "innovation_ekf.csv");
  EXPECT_EQ(innovations_beside(folder_ / "estimate.csv"), std::nullopt);
  EXPECT_EQ(innovations_beside(folder_ / "ekf.csv"), std::nullopt);
}

}  // namespace
}  // namespace montecarta::experiments
