// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/error_anatomy.hpp"
#include "engine/random/stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Standard normal errors of a filter that believes deviations of `believed`.
Credibility credibility_of(double believed, std::size_t runs, std::size_t scans = 40) {
  CredibilitySamples samples(scans);
  for (std::size_t run = 0; run < runs; ++run) {
    RngStream draw({13, run, 0, 0, Draw::test});
    std::vector<Eigen::Vector3d> errors(scans);
    std::vector<double> nees;
    for (Eigen::Vector3d& error : errors) {
      error = {draw.normal(), draw.normal(), draw.normal()};
      nees.push_back(error.squaredNorm() / (believed * believed));
    }
    samples.add(errors, nees);
  }
  return samples.result();
}

TEST(Credibility, IsNearZeroWhereTheCovarianceIsRight) {
  const Credibility found = credibility_of(1.0, 400);
  EXPECT_NEAR(found.inclination, 0.0, 0.1);
  EXPECT_LT(found.noncredibility, 0.5);
}

TEST(Credibility, IsTheFactorInDecibelAndTellsItsSide) {
  const Credibility sure = credibility_of(0.5, 400);
  EXPECT_NEAR(sure.inclination, 20.0 * std::log10(2.0), 0.1);
  EXPECT_NEAR(sure.noncredibility, sure.inclination, 0.01);
  EXPECT_NEAR(credibility_of(2.0, 400).inclination, -20.0 * std::log10(2.0), 0.1);
  EXPECT_NEAR(credibility_of(2.0, 400).noncredibility, 20.0 * std::log10(2.0), 0.1);
}

TEST(Credibility, KeepsEveryThScanOfALongRun) {
  EXPECT_NEAR(credibility_of(0.5, 50, 1000).inclination, 20.0 * std::log10(2.0), 0.3);
}

// Two million samples are too many to keep: then it is every second scan, here those of which the
// filter is overconfident.
TEST(Credibility, KeepsEverySecondScanOfVeryManyRuns) {
  constexpr std::size_t kScans = 100, kRuns = 20'200;
  CredibilitySamples samples(kScans);
  RngStream draw({19, 0, 0, 0, Draw::test});
  std::vector<Eigen::Vector3d> errors(kScans);
  std::vector<double> nees(kScans);
  for (std::size_t run = 0; run < kRuns; ++run) {
    for (std::size_t s = 0; s < kScans; ++s) {
      errors[s] = {draw.normal(), draw.normal(), draw.normal()};
      nees[s] = (s % 2 == 1 ? 4.0 : 1.0) * errors[s].squaredNorm();
    }
    samples.add(errors, nees);
  }
  EXPECT_NEAR(samples.result().inclination, 10.0 * std::log10(4.0), 0.2);
}

TEST(Credibility, SaysNothingOfFewRuns) {
  EXPECT_TRUE(std::isnan(credibility_of(1.0, 9).noncredibility));
}

TEST(Credibility, LeavesOutAScanWhoseErrorsSpanNoSpace) {
  CredibilitySamples samples(2);
  RngStream draw({31, 0, 0, 0, Draw::test});
  for (int run = 0; run < 400; ++run) {
    const Eigen::Vector3d error(draw.normal(), draw.normal(), draw.normal());
    samples.add(std::vector<Eigen::Vector3d>{{1.0, 0.0, 0.0}, error},
                std::vector{1e6, error.squaredNorm()});
  }
  EXPECT_NEAR(samples.result().inclination, 0.0, 0.9);  // 5 standard errors; 60 dB of the first
}

TEST(Credibility, LeavesOutWhatIsNotFinite) {
  CredibilitySamples samples(1);
  for (int run = 0; run < 20; ++run) {
    RngStream draw({17, static_cast<std::uint64_t>(run), 0, 0, Draw::test});
    const Eigen::Vector3d error(draw.normal(), draw.normal(), draw.normal());
    const double nees = run == 3 ? std::nan("") : run == 4 ? 0.0 : error.squaredNorm();
    samples.add(std::vector{error}, std::vector{nees});
  }
  EXPECT_TRUE(std::isfinite(samples.result().noncredibility));
}

}  // namespace
}  // namespace montecarta::analysis
