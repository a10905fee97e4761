// SPDX-License-Identifier: BSD-3-Clause
// Truths that are not in files of their own, have errors, or are seen from another frame.
#include "analysis/study/study_analysis.hpp"
#include "engine/records/result_file.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

namespace montecarta::experiments {
namespace {

class JudgeTruths : public BlinkProgram {
 protected:
  /// The first cell of judged files, which are all called e_0.csv and e_1.csv.
  analysis::CellAnalysis judged(const std::vector<std::string>& more) const {
    const Called called =
        call_with({"judge", "e_0.csv", "e_1.csv", "-o", "mine.h5", "--force"}, more);
    EXPECT_EQ(called.code, 0) << called.err;
    err_ = called.err;
    out_ = called.out;
    return analysis::analyze(ResultFile(folder_ / "mine.h5")).cells[0];
  }
  void write_both(const std::string& header, const std::string& first,
                  const std::string& second) const {
    write("e_0.csv", header + "\n" + first);
    write("e_1.csv", header + "\n" + second);
  }

  mutable std::string err_, out_;
};

TEST_F(JudgeTruths, MayBeColumnsOfTheEstimates) {
  write_both("time_s,true_a_m,a_m,cov_a_a", "1,5,7,4\n2,5,7,4\n", "1,8,6,4\n2,6,6,4\n");
  const auto cell = judged({});
  EXPECT_NEAR(cell.nees[0].mean, 0.75, 1e-12);
  EXPECT_THAT(call({"judge", "e_0.csv", "--truth", "e_1.csv", "-o", "x.h5"}).err,
              HasSubstr("--truth: not beside e_0.csv (its columns begin with true_"));
  write_both(
      "time_s,x_m,y_m,yaw_rad,true_x_m,true_y_m,true_yaw_rad,cov_0_0,cov_0_1,cov_0_2,"
      "cov_1_1,cov_1_2,cov_2_2",
      "1,1,0,3,0,0,3,1,0,0,1,0,1\n", "1,0,0,3.1,0,0,-3.1,1,0,0,1,0,1\n");
  EXPECT_NEAR(judged({"--error", "world"}).nees[0].mean, 0.5 * (1.0 + std::pow(0.0831853, 2)),
              1e-6);
}

TEST_F(JudgeTruths, AreNotNeededForErrors) {
  write_both("time_s,error_a_m,error_turn_rad,cov_a_a,cov_a_turn,cov_turn_turn",
             "1,2,0,4,0,1\n2,2,0,4,0,1\n", "1,0,1,4,0,1\n2,0,2,4,0,1\n");
  const auto cell = judged({});
  EXPECT_NEAR(cell.nees[0].mean, (1 + 1 + 1 + 4) / 4.0, 1e-12);
  EXPECT_THAT(out_, HasSubstr("components a, turn."));
  write("e_0.csv", "time_s,a_m,cov_a_a\n1,2,4\n");
  EXPECT_THAT(call({"judge", "e_0.csv", "-o", "x.h5"}).err,
              AllOf(HasSubstr("--truth PATH... is missing"), HasSubstr("error_x_m")));
}

// The errors of estimate and truth have the sum of both covariances.
TEST_F(JudgeTruths, MayHaveCovariances) {
  write_both("time_s,a_m,cov_a_a", "1,2,3\n3,2,3\n", "1,2,3\n3,2,3\n");
  write("truth.csv", "time_s,a_m,cov_a_a\n1,0,1\n2,0,5\n4,0,5\n");
  const auto cell = judged({"--truth", "truth.csv", "--interpolate", "--truth-cov"});
  EXPECT_NEAR(cell.nees[0].series.average[0], 4.0 / (3.0 + 1.0), 1e-12);
  EXPECT_NEAR(cell.nees[0].series.average[1], 4.0 / (3.0 + 5.0), 1e-12);
  EXPECT_THAT(out_, HasSubstr("covariances of the truth's own errors were added"));
  EXPECT_NEAR(judged({"--truth", "truth.csv", "--interpolate"}).nees[0].series.average[0],
              4.0 / 3.0, 1e-12);
  write("truth.csv", "time_s,a_m,cov_a_a\n1,0,1\n3,0,-1\n");
  EXPECT_THAT(
      call({"judge", "e_0.csv", "--truth", "truth.csv", "--truth-cov", "-o", "x.h5"}).err,
      HasSubstr("truth.csv:3: the covariance of the truth is not symmetric or not positive"));
}

TEST_F(JudgeTruths, AreMovedOntoTheFirstEstimate) {
  const std::string P = ",1,0,0,1,0,1\n";
  write_both("time_s,x_m,y_m,heading_rad,cov_0_0,cov_0_1,cov_0_2,cov_1_1,cov_1_2,cov_2_2",
             "0,10,5,1.5,0,0,0,0,0,0\n1,10,7,1.5" + P, "0,10,5,1.5,0,0,0,0,0,0\n1,10,6,1.5" + P);
  write("truth.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n1,1,0,0\n");
  const auto cell = judged({"--truth", "truth.csv", "--anchor", "yaw", "--error", "world"});
  ASSERT_EQ(cell.nees[0].series.average.size(), 1U);
  const double along = std::cos(1.5), up = std::sin(1.5);  // where the truth is after one second
  EXPECT_NEAR(cell.nees[0].mean,
              0.5 * (2 * along * along + std::pow(2 - up, 2) + std::pow(1 - up, 2)), 1e-12);
  EXPECT_EQ(cell.verdict.missing, 0U);
  EXPECT_THAT(out_, HasSubstr("moved by position and heading onto its first estimate"));
  EXPECT_THAT(err_, Not(HasSubstr("bound")));
  EXPECT_FALSE(cell.verdict.is_by_upper_bounds);
}

// The moved errors have the error of the anchor, whose correlation with theirs is not known.
TEST_F(JudgeTruths, AreBoundedWhereTheAnchorIsUncertain) {
  const std::string P = ",1,0,0,1,0,1\n";
  write_both("time_s,x_m,y_m,heading_rad,cov_0_0,cov_0_1,cov_0_2,cov_1_1,cov_1_2,cov_2_2",
             "0,10,5,0" + P + "1,10,7,0" + P, "0,10,5,0" + P + "1,10,6,0" + P);
  write("truth.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n1,0,0,0\n");
  const auto cell = judged({"--truth", "truth.csv", "--anchor", "first", "--error", "world"});
  const double t = std::sqrt(0.5);  // the shares are 1/2, 1/2, 0 and 1/2, 1/2, 1
  EXPECT_NEAR(cell.nees[0].mean, 0.5 * (4.0 + 1.0) / (2.0 + t + 1.0 / t), 1e-9);
  EXPECT_TRUE(cell.verdict.is_by_upper_bounds);
  EXPECT_THAT(out_, HasSubstr("leave out --anchor"));
  EXPECT_THAT(err_, HasSubstr("deviations up to 1 m of x in e_0.csv"));
}

// The header of EuRoC is a comment, so that its first row would be the header.
TEST_F(JudgeTruths, NeedAHeaderThatIsNoComment) {
  write("e_0.csv", "#timestamp [ns], p_x, p_y\n1403636579763555584,1,2\n");
  write("truth.csv", "time_s,x_m,y_m\n1,0,0\n");
  EXPECT_THAT(call({"judge", "e_0.csv", "--truth", "truth.csv", "-o", "x.h5"}).err,
              AllOf(HasSubstr("e_0.csv:2: '1403636579763555584' is a number"),
                    HasSubstr("begins with # is a comment"), HasSubstr("estimates.py")));
}

}  // namespace
}  // namespace montecarta::experiments
