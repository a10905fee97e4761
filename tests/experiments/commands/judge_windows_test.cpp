// SPDX-License-Identifier: BSD-3-Clause
// Errors of increments over windows of time.
#include "analysis/run/imported_state.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/commands/program.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

/// `a` followed by `b`, which is seen from `a`.
Vector3d followed(const Vector3d& a, const Vector3d& b) {
  Vector3d c;
  c << a.head<2>() + Eigen::Rotation2Dd(a(2)) * Eigen::Vector2d(b.head<2>()), a(2) + b(2);
  return c;
}

Matrix3d adjoint(const Vector3d& pose) {
  Matrix3d found = Matrix3d::Identity();
  found.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(pose(2)).toRotationMatrix();
  found(0, 2) = pose.y();
  found(1, 2) = -pose.x();
  return found;
}

Vector3d inverse(const Vector3d& pose) {
  Vector3d found;
  found << -(Eigen::Rotation2Dd(-pose(2)) * Eigen::Vector2d(pose.head<2>())), -pose(2);
  return found;
}

const Vector3d kStep(1.0, 0.1, 0.3);
const Matrix3d kOfStep{{0.04, 0.01, 0.0}, {0.01, 0.02, 0.001}, {0.0, 0.001, 0.003}};

/// Odometry of eleven steps that are each kStep, with the covariance kOfStep in the body, under a
/// convention. The true steps are longer by 0.1 m.
class JudgeWindows : public BlinkProgram {
 protected:
  void write_odometry(const std::string& convention) const {
    std::string text = "time_s,x_m,y_m,heading_rad", truths = text + "\n";
    for (int k = 0; k < 9; ++k)
      text += ",cov_" + std::to_string(k / 3) + "_" + std::to_string(k % 3);
    Vector3d mean(5.0, -3.0, 1.0), truth = mean;
    Matrix3d P = 0.5 * Matrix3d::Identity();
    for (int k = 0; k < 12; ++k) {
      Matrix3d to = Matrix3d::Identity();
      if (convention == "right-invariant") to = adjoint(mean);
      if (convention == "world") to.topLeftCorner<2, 2>() = adjoint(mean).topLeftCorner<2, 2>();
      const Matrix3d written = to * P * to.transpose();
      text += "\n" + std::to_string(k);
      for (const double value : mean) text += "," + to_text(value);
      for (const double value : written.reshaped()) text += "," + to_text(value);
      truths += std::to_string(k);
      for (const double value : truth) truths += "," + to_text(value);
      truths += "\n";
      mean = followed(mean, kStep);
      truth = followed(truth, kStep + Vector3d(0.1, 0.0, 0.0));
      const Matrix3d carried = adjoint(inverse(kStep));
      P = carried * P * carried.transpose() + kOfStep;
    }
    write("odometry.csv", text + "\n");
    write("truth.csv", truths);
  }
  Called judged(const std::vector<std::string>& more) const {
    return call_with({"judge", "odometry.csv", "--truth", "truth.csv", "-o", "mine.h5", "--force"},
                     more);
  }
};

// Law: the covariance of an increment is what was added since its start, under every convention.
TEST_F(JudgeWindows, HaveTheCovarianceThatWasAdded) {
  for (const std::string convention : {"world", "body", "right-invariant"}) {
    write_odometry(convention);
    const Called called = judged({"--error", convention, "--windows", "1,5"});
    ASSERT_EQ(called.code, 0) << called.err;
    EXPECT_THAT(called.out, AllOf(HasSubstr("increments over 1, 5 s (x, y, heading)"),
                                  HasSubstr("odometry.1s"), Not(HasSubstr("missing"))));
    const ResultFile file(folder_ / "mine.h5");
    ASSERT_EQ(file.cells().size(), 2u);
    const std::size_t scans = file.times().size();
    ASSERT_EQ(scans, 11u);
    std::vector<double> error(3 * scans), P(9 * scans);
    file.read(file.cells()[0], "error", 0, std::span(error));
    file.read(file.cells()[0], "error_covariance", 0, std::span(P));
    for (std::size_t s = 0; s < scans; ++s) {
      EXPECT_LT((Matrix3d::Map(P.data() + 9 * s) - kOfStep).norm(), 1e-9) << convention << s;
      EXPECT_NEAR(error[3 * s], -0.1 * std::cos(kStep(2)), 1e-9) << "seen from the end of the step";
    }
    file.read(file.cells()[1], "error", 0, std::span(error));
    EXPECT_TRUE(std::isnan(error[3 * 3])) << "five seconds are not over";
    EXPECT_FALSE(std::isnan(error[3 * 4]));
  }
}

// A filter with a map has the same covariance all the time, and none of its increments.
TEST_F(JudgeWindows, HaveABoundWhereEstimatesAreCorrected) {
  const auto write_filter = [&](double error) {
    std::string text =
        "time_s,x_m,y_m,heading_rad,cov_0_0,cov_0_1,cov_0_2,cov_1_1,cov_1_2,cov_2_2\n";
    std::string truths = "time_s,x_m,y_m,heading_rad\n";
    for (int k = 0; k < 60; ++k) {
      text += std::to_string(k) + "," + to_text(k + (k % 2 == 0 ? error : -error)) +
              ",0,0,1,0,0,1,0,1\n";
      truths += std::to_string(k) + "," + std::to_string(k) + ",0,0\n";
    }
    write("odometry.csv", text);
    write("truth.csv", truths);
    const Called called = judged({"--error", "world", "--windows", "1"});
    EXPECT_EQ(called.code, 0) << called.err;
    EXPECT_THAT(called.out, HasSubstr("judged by a bound that their errors cannot exceed"));
    EXPECT_THAT(called.out, Not(HasSubstr("unusable")));
    std::vector<double> P(9 * 59);
    const ResultFile file(folder_ / "mine.h5");
    file.read(file.cells()[0], "error_covariance", 0, std::span(P));
    EXPECT_GE(P[0], 4.0 - 1e-9) << "errors of both ends that go against each other";
    return called.out;
  };
  EXPECT_THAT(write_filter(0.0), HasSubstr("odometry.1s is undecided"));
  EXPECT_THAT(write_filter(9.0), HasSubstr("odometry.1s is optimistic"));
}

// A filter with a map beside odometry takes no covariance from it.
TEST_F(JudgeWindows, OfOneEstimatorAreBoundedAndOfAnotherNot) {
  write_odometry("world");
  write("odometry_0.csv", text_of("odometry.csv"));
  std::string filter = "time_s,x_m,y_m,heading_rad,cov_0_0,cov_1_1,cov_2_2\n";
  for (int k = 0; k < 12; ++k)
    filter += std::to_string(k) + "," + std::to_string(k) + ",0,0,1,1,1\n";
  write("filter_0.csv", filter);
  const auto covariances = [&](const std::vector<std::string>& files) {
    std::vector<std::string> words = {"judge"};
    words.insert(words.end(), files.begin(), files.end());
    const Called called = call_with(words, {"--truth", "truth.csv", "--error", "world", "--windows",
                                            "1,5", "-o", "mine.h5", "--force"});
    EXPECT_EQ(called.code, 0) << called.err;
    const ResultFile file(folder_ / "mine.h5");
    std::map<std::string, std::vector<double>> all;
    for (const StoredCell& cell : file.cells()) {
      EXPECT_EQ(analysis::has_bounds(cell.settings), cell.label.starts_with("filter."))
          << cell.label;
      std::vector<double> P(9 * file.times().size());
      file.read(cell, "error_covariance", 0, std::span(P));
      std::ranges::replace_if(
          P, [](double value) { return std::isnan(value); }, -1.0);
      all[cell.label] = P;
    }
    if (files.size() > 1) {
      EXPECT_THAT(called.out,
                  AllOf(HasSubstr("increments of odometry.1s, odometry.5s is what was added"),
                        HasSubstr("no covariance for increments of filter.1s, filter.5s")));
    }
    return all;
  };
  const auto together = covariances({"odometry_0.csv", "filter_0.csv"});
  EXPECT_EQ(together.size(), 4u);
  for (const std::string file : {"odometry", "filter"}) {
    for (const auto& [cell, P] : covariances({file + "_0.csv"})) {
      ASSERT_EQ(together.count(cell), 1u) << cell;
      EXPECT_EQ(together.at(cell), P) << cell;
    }
  }
}

TEST_F(JudgeWindows, AreOfPosesAndIncrease) {
  write_odometry("body");
  EXPECT_THAT(judged({"--windows", "1,5"}).err, HasSubstr("--error is missing"));
  EXPECT_THAT(judged({"--error", "body", "--windows", "5,1"}).err,
              HasSubstr("--windows 5,1: not a list of increasing lengths"));
  EXPECT_THAT(judged({"--error", "body", "--windows", "1", "--anchor", "yaw"}).err,
              HasSubstr("--anchor: not beside --windows"));
  std::string degrees = "time_s,x_m,y_m,heading_rad,cov_0_0,cov_1_1,cov_2_2\n", truths = degrees;
  for (int k = 0; k < 30; ++k) {
    const std::string pose = std::to_string(k) + "," + std::to_string(-k) + ",0,180";
    degrees += pose + ",1,1,1\n";
    truths += pose + ",0,0,0\n";
  }
  write("odometry.csv", degrees);
  write("truth.csv", truths);
  EXPECT_THAT(judged({"--error", "world", "--windows", "1"}).err,
              HasSubstr("heading_rad 180 (more than two turns; it is judged as rad)"));
  write("odometry.csv", "time_s,a,cov_a_a\n1,0,1\n2,0,1\n");
  write("truth.csv", "time_s,a\n1,0\n2,0\n");
  EXPECT_THAT(judged({"--windows", "1"}).err, HasSubstr("--windows is for poses"));
}

}  // namespace
}  // namespace montecarta::experiments
