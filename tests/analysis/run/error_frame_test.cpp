// SPDX-License-Identifier: BSD-3-Clause
// Law: errors that have the reported covariance have no bias and no correlation in the frame in
// which they are judged, whether the truth scatters about the data or the estimates about the
// truth.
#include "analysis/run/criteria_of.hpp"
#include "analysis/run/measured_run.hpp"
#include "analysis/run/run_criteria.hpp"
#include "analysis/run/run_metrics.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/records/result_file.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kScansInFrame = 20;

/// The poses that scatter.
enum class Scatter { truth, estimate };

/// In the frame of the vehicle: a deviation of 2 m to the left that is nearly all due to the
/// heading, and of 0.3 m forward.
Eigen::Matrix3d covariance_in_vehicle() {
  const Eigen::Vector3d sigma(0.3, 2.0, 0.1);
  const Eigen::Matrix3d correlation{{1.0, 0.2, 0.3}, {0.2, 1.0, 0.9}, {0.3, 0.9, 1.0}};
  return sigma.asDiagonal() * correlation * sigma.asDiagonal();
}

/// The covariance at a scan, in the map.
Eigen::Matrix3d covariance_at(double heading) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return turn * covariance_in_vehicle() * turn.transpose();
}

Eigen::Vector3d fixed_pose(std::size_t scan) {
  const auto t = static_cast<double>(scan);
  return {3.0 * t, 10.0 * std::sin(0.1 * t), wrap(0.5 * t)};
}

Eigen::Vector3d drawn_error(const Eigen::Matrix3d& P, RngStream& draw) {
  const Eigen::Vector3d noise(draw.normal(), draw.normal(), draw.normal());
  return P.llt().matrixL() * noise;
}

void add_scan(const Eigen::Vector3d& truth, const Eigen::Vector3d& mean, const Eigen::Matrix3d& P,
              RunRows& rows) {
  rows.truth.insert(rows.truth.end(), truth.begin(), truth.end());
  rows.spread.mean.insert(rows.spread.mean.end(), mean.begin(), mean.end());
  rows.spread.covariance.insert(rows.spread.covariance.end(), P.data(), P.data() + 9);
  rows.numerical_faults.push_back(0);
}

/// Errors that are drawn from exactly the covariance that is reported. That is fixed, and so are
/// the truths or the estimates.
RunRows drawn_rows(Scatter scatter, std::uint64_t run) {
  RngStream draw({.seed = 57, .run = run, .purpose = Draw::test});
  RunRows rows;
  for (std::size_t s = 0; s < kScansInFrame; ++s) {
    const Eigen::Vector3d fixed = fixed_pose(s);
    const Eigen::Matrix3d P = covariance_at(fixed(2));
    const Eigen::Vector3d error = drawn_error(P, draw);
    const Eigen::Vector3d truth =
        scatter == Scatter::truth ? Eigen::Vector3d(fixed - error) : fixed;
    add_scan(truth, truth + error, P, rows);
  }
  return rows;
}

/// An ideal particle filter: truth and particles are drawn alike.
RunRows sampled_rows(std::size_t particles, std::uint64_t run) {
  RngStream draw({.seed = 58, .run = run, .purpose = Draw::test});
  RunRows rows;
  for (std::size_t s = 0; s < kScansInFrame; ++s) {
    const Eigen::Vector3d fixed = fixed_pose(s);
    const Eigen::Matrix3d P = covariance_at(fixed(2));
    const auto n = static_cast<Eigen::Index>(particles);
    Eigen::Matrix3Xd about(3, n);
    for (Eigen::Index i = 0; i < n; ++i) about.col(i) = drawn_error(P, draw);
    const Eigen::Vector3d mean = about.rowwise().mean();
    about.colwise() -= mean;
    const Eigen::Matrix3d spread = about * about.transpose() / static_cast<double>(particles);
    add_scan(fixed + drawn_error(P, draw), fixed + mean, spread, rows);
    rows.ess.push_back(static_cast<double>(particles));
  }
  return rows;
}

/// Student's t over runs of the means of the standardised components, and of the products of two
/// whitened ones.
struct StudentsT {
  std::array<double, 3> bias, correlation;
};

/// Adds the mean over the scans of one run.
template <class Term>
void add_mean(const Term& term, SummaryOf& sum) {
  double mean = 0.0;
  for (std::size_t s = 0; s < kScansInFrame; ++s) mean += term(s) / kScansInFrame;
  sum.add(mean);
}

template <class Rows>
StudentsT students_t(const Rows& rows_of, std::uint64_t runs, std::size_t particles,
                     ErrorFrame frame) {
  const std::vector<double> times = scan_times(kScansInFrame);
  RunCriteria criteria = criteria_of_scans(times);
  criteria.frame = frame;
  MeasuredRun measured;
  std::array<SummaryOf, 3> bias, correlation;
  for (std::uint64_t run = 0; run < runs; ++run) {
    measured.rows = rows_of(run);
    measured.measure(criteria, particles);
    const WhitenedRun& errors = measured.metrics.whitened();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      add_mean([&](std::size_t s) { return errors.standardised[3 * s + k]; }, bias[k]);
      add_mean(
          [&](std::size_t s) { return errors.whitened[3 * s + k] * errors.whitened[3 * s + next]; },
          correlation[k]);
    }
  }
  StudentsT found;
  const auto t_of = [](const SummaryOf& sum) {
    const Summary all = sum.result();
    return all.mean / all.standard_error();
  };
  std::ranges::transform(bias, found.bias.begin(), t_of);
  std::ranges::transform(correlation, found.correlation.begin(), t_of);
  return found;
}

/// Of 200 runs of a filter with one Gaussian.
StudentsT students_t(Scatter scatter, ErrorFrame frame) {
  return students_t([=](std::uint64_t run) { return drawn_rows(scatter, run); }, 200, 0, frame);
}

void expect_none(const StudentsT& t) {
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(std::abs(t.bias[k]), 4.0) << "bias of component " << k;
    EXPECT_LT(std::abs(t.correlation[k]), 4.0) << "correlation of component " << k;
  }
}

// 4 standard errors.
TEST(ErrorFrame, HasNoBiasIfItDoesNotDependOnTheError) {
  expect_none(students_t(Scatter::truth, ErrorFrame::of_estimate));
  expect_none(students_t(Scatter::estimate, ErrorFrame::of_truth));
}

// The error forward gets cov(left, heading) = 0.18 m, more than half of its deviation of 0.3 m.
TEST(ErrorFrame, HasABiasIfItDependsOnTheError) {
  EXPECT_GT(std::abs(students_t(Scatter::truth, ErrorFrame::of_truth).bias[0]), 20.0);
  EXPECT_GT(std::abs(students_t(Scatter::estimate, ErrorFrame::of_estimate).bias[0]), 20.0);
}

// In the frame of the mean of ten draws itself t is 8.8: that mean has a tenth of the covariance.
TEST(ErrorFrame, HasNoBiasIfTheEstimateIsTheMeanOfFewDraws) {
  expect_none(students_t([](std::uint64_t run) { return sampled_rows(10, run); }, 1000, 10,
                         ErrorFrame::of_estimate));
}

// With a mixture stored, poses that a scan drew are judged by their own mean. Here they head along
// y, the mixture along x, and the error is along x.
TEST(ErrorFrame, IsOfTheMeanThatIsJudged) {
  const std::vector<double> times = scan_times(1);
  RunCriteria criteria = criteria_of_scans(times);
  criteria.frame = ErrorFrame::of_estimate;
  MeasuredRun measured;
  RunRows& rows = measured.rows;
  const Eigen::Matrix3d P = Eigen::Vector3d(1.0, 1.0, 100.0).asDiagonal();
  rows.truth = {0.0, 0.0, 0.0};
  rows.mixture.mean = {1.0, 0.0, 0.0};
  rows.spread.mean = {1.0, 0.0, kPi / 2.0};
  rows.spread.covariance = {P.data(), P.data() + 9};
  rows.mixture.covariance = {1.1, 0.0, 0.0, 0.0, 1.1, 0.0, 0.0, 0.0, 100.1};
  rows.ess = {1000.0};
  rows.numerical_faults = {0};
  measured.measure(criteria, 1000);
  EXPECT_NEAR(measured.metrics.errors()[0].x(), 1.0, 1e-12);
  EXPECT_NEAR(measured.metrics.whitened().standardised[0], 0.0, 0.01);
  EXPECT_NEAR(measured.metrics.whitened().standardised[1], -1.0, 0.01);
}

/// Scripted drives, all with the same headings, or each run with headings of its own.
class TurnedDrives final : public ScriptedDrives {
 public:
  TurnedDrives(std::size_t steps, double turn) : ScriptedDrives(steps), turn_(turn) {}
  void generate(std::uint64_t run, Drive& drive) const override {
    ScriptedDrives::generate(run, drive);
    for (Pose& pose : drive.truth) pose.heading += turn_ * static_cast<double>(run);
  }

 private:
  double turn_;
};

class ErrorFrameOfAFile : public testing::Test {
 protected:
  /// The frame for a file with these settings of the scenario, in which the headings of each run
  /// differ by `turn` [rad] from those of the run before.
  ErrorFrame frame_of(const TextPairs& scenario, std::uint64_t runs, double turn) const {
    const auto path = folder_ / "out.h5";
    const std::size_t steps = 24;
    write_synthetic_result(path, runs, steps, {}, [&](StudyPlan& plan) {
      plan.scenario = scenario;
      plan.drives = std::make_shared<TurnedDrives>(steps, turn);
    });
    return criteria_of(ResultFile(path), 0.95).frame;
  }

  ScratchFolder folder_;
};

// A shard of one run has the frame that the other shards have.
TEST_F(ErrorFrameOfAFile, FollowsFromTheScenario) {
  for (const std::uint64_t runs : {1u, 3u}) {
    EXPECT_EQ(frame_of({{"noise", "matched"}}, runs, 0.1), ErrorFrame::of_estimate);
    EXPECT_EQ(frame_of({{"noise", "measured-control"}}, runs, 0.0), ErrorFrame::of_truth);
  }
}

TEST_F(ErrorFrameOfAFile, FollowsFromTheHeadingsWhereTheScenarioDoesNotTell) {
  EXPECT_EQ(frame_of({{"kind", "imported"}}, 3, 0.1), ErrorFrame::of_estimate);
  EXPECT_EQ(frame_of({{"kind", "imported"}}, 3, 0.0), ErrorFrame::of_truth);
}

}  // namespace
}  // namespace montecarta::analysis
