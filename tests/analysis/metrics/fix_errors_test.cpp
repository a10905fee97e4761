// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/drive_scores.hpp"
#include "analysis/metrics/nees.hpp"
#include "analysis/statistics/sampler_scale.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace montecarta::analysis {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;

const std::vector<double> kScanTimes = {1.0, 2.0, 4.0};

/// The vehicle is at (t, 0) at time t; its variance along x at the scans is as given.
RunRows rows_with(const std::vector<double>& x_variances) {
  RunRows rows;
  for (std::size_t s = 0; s < kScanTimes.size(); ++s) {
    rows.spread.mean.insert(rows.spread.mean.end(), {kScanTimes[s], 0.0, 0.1});
    rows.spread.covariance.insert(rows.spread.covariance.end(),
                                  {x_variances[s], 0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.2, 0.5});
  }
  return rows;
}

/// One fix that is `error` off, at `time`, with these variances.
ReferencePath fix_at(double time, const Eigen::Vector3d& error, const Eigen::Vector3d& variances) {
  ReferencePath path{"gps", {time}, {{time - error(0), -error(1)}}, {wrap(0.1 - error(2))}};
  path.covariance = {variances.asDiagonal()};
  return path;
}

FixErrors errors_of(const ReferencePath& path, const RunRows& rows, ErrorBlock block,
                    std::size_t particles = 0) {
  const PathAtFixes fixes(path, kScanTimes, {0.0, 0.0, 0.1});
  return errors_at_fixes(fixes, kScanTimes, rows, particles, block);
}

TEST(FixErrors, AreInUnitsOfBothCovariances) {
  const ReferencePath path = fix_at(1.5, {2.0, 0.0, 0.0}, {2.0, 1.0, 1.0});
  // Halfway between the scans the variance is halfway between 1 and 3.
  const FixErrors position = errors_of(path, rows_with({1.0, 3.0, 1.0}), ErrorBlock::position);
  EXPECT_THAT(position.nees, ElementsAre(DoubleNear(1.0, 1e-12)));
  EXPECT_EQ(position.whitened.size(), 2U);
  EXPECT_THAT(position.whitened[0], ElementsAre(DoubleNear(1.0, 1e-12)));
  EXPECT_THAT(position.by_reference[0], ElementsAre(DoubleNear(std::sqrt(2.0), 1e-12)));
  EXPECT_THAT(position.times, ElementsAre(1.5));
  const FixErrors pose = errors_of(path, rows_with({1.0, 3.0, 1.0}), ErrorBlock::pose);
  EXPECT_THAT(pose.nees, ElementsAre(DoubleNear(1.0, 1e-12)));
}

TEST(FixErrors, KnowTheWholeCovarianceAndTheShorterWayRound) {
  const Eigen::Vector3d error(0.5, -1.0, 0.4);
  ReferencePath path = fix_at(2.0, error, {1e-20, 1e-20, 1e-20});
  Eigen::Matrix3d P;
  P << 3.0, 0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.2, 0.5;
  const RunRows rows = rows_with({1.0, 3.0, 1.0});
  EXPECT_NEAR(errors_of(path, rows, ErrorBlock::pose).nees[0], nees<3>(error, P).value, 1e-9);
  EXPECT_NEAR(errors_of(path, rows, ErrorBlock::heading).nees[0], 0.16 / 0.5, 1e-9);
  path.heading[0] += kTwoPi;
  EXPECT_NEAR(errors_of(path, rows, ErrorBlock::heading).nees[0], 0.16 / 0.5, 1e-9);
}

TEST(FixErrors, LeaveOutAndCountWhatCannotBeJudged) {
  const RunRows rows = rows_with({1.0, 1.0, 1.0});
  const FixErrors gap = errors_of(fix_at(3.0, {1, 1, 1}, {1, 1, 1}), rows, ErrorBlock::pose);
  EXPECT_THAT(gap.nees, IsEmpty());
  EXPECT_EQ(gap.in_gaps, 1U);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const FixErrors undefined =
      errors_of(fix_at(1.5, {1, 1, 1}, {1, 1, 1}), rows_with({1.0, nan, 1.0}), ErrorBlock::pose);
  EXPECT_EQ(undefined.undefined, 1U);
  const FixErrors indefinite =
      errors_of(fix_at(2.0, {1, 1, 1}, {1, 1, 1}), rows_with({1.0, -9.0, 1.0}), ErrorBlock::pose);
  EXPECT_EQ(indefinite.undefined, 1U);
  EXPECT_EQ(errors_of(fix_at(0.5, {1, 1, 1}, {1, 1, 1}), rows, ErrorBlock::pose).nees.size(), 1U);
}

TEST(FixErrors, AreNoneWithoutCovarianceOrHeading) {
  ReferencePath path = fix_at(1.5, {1, 1, 1}, {1, 1, 1});
  RunRows rows = rows_with({1.0, 1.0, 1.0});
  path.heading.clear();
  EXPECT_THAT(errors_of(path, rows, ErrorBlock::pose).nees, IsEmpty());
  EXPECT_EQ(errors_of(path, rows, ErrorBlock::position).nees.size(), 1U);
  rows.spread.covariance.clear();
  EXPECT_THAT(errors_of(path, rows, ErrorBlock::position).nees, IsEmpty());
}

// With an exact reference drawn poses are judged as where the truth is known, with a coarse one as
// a Gaussian.
TEST(FixErrors, OfDrawnPosesGoFromTheOneScaleToTheOther) {
  const Eigen::Vector3d error(2.0, 2.0, 1.0);
  Eigen::Matrix3d P;
  P << 3.0, 0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.2, 0.5;
  const RunRows rows = rows_with({1.0, 3.0, 1.0});
  const EffectiveDraws draws = effective_draws(20, 20.0);
  const double exact =
      errors_of(fix_at(2.0, error, {1e-20, 1e-20, 1e-20}), rows, ErrorBlock::pose, 20).nees[0];
  EXPECT_NEAR(exact, SamplerScale(3)(nees<3>(error, P).value, draws), 1e-6);
  EXPECT_LT(exact, nees<3>(error, P).value);
  const double coarse =
      errors_of(fix_at(2.0, error, {1e4, 1e4, 1e4}), rows, ErrorBlock::pose, 20).nees[0];
  EXPECT_NEAR(coarse, 9.0 / 1e4, 1e-6);
  EXPECT_EQ(errors_of(fix_at(2.0, error, {1, 1, 1}), rows, ErrorBlock::pose, 5).undefined, 1U)
      << "five draws cannot be judged";
}

}  // namespace
}  // namespace montecarta::analysis
