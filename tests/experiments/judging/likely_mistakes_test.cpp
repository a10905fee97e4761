// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/likely_mistakes.hpp"

#include "engine/text/list_text.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"

#include <cfloat>

namespace montecarta::experiments {
namespace {

const StateShape kPoseInSpace = {StateKind::pose_in_space,
                                 {"x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"},
                                 {"x", "y", "z", "rx", "ry", "rz"},
                                 {"m", "m", "m", "rad", "rad", "rad"}};

/// Ten poses in space at the origin, turned by `q` (x, y, z, w), with these variances.
StateRows rows_with(const Eigen::VectorXd& variances, double x = 0.0,
                    const Eigen::Vector4d& q = {0.0, 0.0, 0.6, 0.8}) {
  StateRows rows{kPoseInSpace, {}, {}, {}, {}, {}};
  for (std::size_t k = 0; k < 10; ++k) {
    rows.time.push_back(static_cast<double>(k));
    rows.line.push_back(k + 2);
    rows.state.emplace_back(7);
    rows.state.back() << x, 0.0, 0.0, q;
    rows.covariance.emplace_back(variances.asDiagonal());
  }
  return rows;
}

Eigen::VectorXd planar(double unknown) {
  Eigen::VectorXd variances(6);
  variances << 0.04, 0.09, unknown, unknown, unknown, 0.0025;
  return variances;
}

/// Notes on estimates, whose truth is at 1 m.
std::string notes_on(const StateRows& rows,
                     const StateRows& truth = rows_with(Eigen::VectorXd::Zero(6), 1.0)) {
  const std::vector<std::string> cells = {"ekf"};
  LikelyMistakes mistakes(cells, ErrorConvention::world, true, false);
  mistakes.add_truth(truth, "truth.csv");
  mistakes.add(0, rows, "ekf/run_0.csv", truth);
  return joined(mistakes.notes(), "\n");
}

TEST(LikelyMistakes, AreVariancesThatMarkComponents) {
  for (const double mark : {-1.0, 0.0, 1e-9, 9999.0, 1e6, DBL_MAX}) {
    EXPECT_THAT(notes_on(rows_with(planar(mark))),
                AllOf(HasSubstr("ekf: z, rx, ry have the variance " + to_text(mark)),
                      HasSubstr("10 of 10 rows"), HasSubstr("ekf/run_0.csv:2"),
                      HasSubstr("--components x,y,rz")))
        << mark;
  }
  EXPECT_EQ(notes_on(rows_with(planar(0.01))), "");
  StateRows growing = rows_with(planar(1e5));
  for (std::size_t k = 0; k < growing.covariance.size(); ++k) {
    growing.covariance[k] *= 1.0 + static_cast<double>(k);
  }
  EXPECT_EQ(notes_on(growing), "") << "a variance that was estimated";
}

TEST(LikelyMistakes, AreEstimatesThatEqualTheTruth) {
  EXPECT_THAT(notes_on(rows_with(planar(0.01), 1.0)), HasSubstr("10 of 10 rows"));
}

TEST(LikelyMistakes, AreRowsThatWereNeverWritten) {
  StateRows rows = rows_with(planar(0.01));
  for (const std::size_t k : {0, 9}) {  // the first may be known exactly
    rows.state[k] = rows_with(planar(0.01), 1.0).state[k];
    rows.covariance[k].setZero();
  }
  EXPECT_THAT(notes_on(rows),
              AllOf(HasSubstr("all 0 in 1 of 10 rows, the first in ekf/run_0.csv:11"),
                    Not(HasSubstr("copy"))));
}

TEST(LikelyMistakes, AreQuaternionsWithWFirst) {
  const Eigen::VectorXd variances = planar(0.01);
  const StateRows swapped = rows_with(variances, 0.0, {0.8, 0.0, 0.0, 0.6});
  EXPECT_THAT(notes_on(swapped), HasSubstr("quaternions of the estimates may be written with w"));
  EXPECT_THAT(notes_on(rows_with(variances), swapped), HasSubstr("quaternions of the truth may"));
  EXPECT_EQ(notes_on(rows_with(variances, 0.0, {0.0, 0.0, 0.8, 0.6})), "") << "merely far off";
}

TEST(LikelyMistakes, AreFramesThatDiffer) {
  EXPECT_THAT(notes_on(rows_with(1e-6 * planar(0.01), 9.0)),
              AllOf(HasSubstr("ekf: 1 of 1 run begins far from the truth"),
                    HasSubstr("(8.00 m in ekf/run_0.csv:2): if the frames differ, see --anchor")));
  EXPECT_EQ(notes_on(rows_with(planar(0.01), 9.0)), "")
      << "errors that the covariances may explain";
}

TEST(LikelyMistakes, InUnitsAreRefusedWithTheFactor) {
  const StateRows rows = rows_with(planar(0.01));
  StateRows truth = rows_with(Eigen::VectorXd::Zero(6), 1.0);
  for (double& time : truth.time) time *= 1e9;
  EXPECT_THAT(complaint_of([&] { notes_on(rows, truth); }),
              AllOf(HasSubstr("truth.csv: times look like ns"), HasSubstr("run_0.csv")));
  EXPECT_THAT(complaint_of([&] { notes_on(truth, truth); }), HasSubstr("divide time_s by 1e9"));
}

TEST(LikelyMistakes, AreRowsThatAreLeftOut) {
  StateRows rows = rows_with(planar(0.01));
  rows.left_out = 3;
  EXPECT_THAT(notes_on(rows), HasSubstr("3 rows are left out by --keep"));
}

}  // namespace
}  // namespace montecarta::experiments
