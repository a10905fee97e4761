// SPDX-License-Identifier: BSD-3-Clause
// The verdict is a statistical test, so it is held to its level: how often it rejects a right
// filter, and how often it finds a wrong one.
#include "analysis/metrics/nees.hpp"
#include "analysis/metrics/nees_accumulator.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace montecarta::analysis {
namespace {

/// Errors of a run whose scans go together by `memory` (1: the same error at all scans); deviations
/// `inflation` times as believed.
struct Law {
  double memory = 0.0;
  double inflation = 1.0;
  double bias = 0.0;  ///< of the first component, in its believed deviations
};

RunRows draw_run(const Law& law, std::uint64_t study, std::uint64_t run, std::size_t scans) {
  RngStream draw({study, run, 0, 0, Draw::test});
  RunRows rows;
  rows.truth.assign(3 * scans, 0.0);
  Eigen::Vector3d state(draw.normal(), draw.normal(), draw.normal());
  const double rest = std::sqrt(1.0 - law.memory * law.memory);
  for (std::size_t s = 0; s < scans; ++s) {
    const Eigen::Vector3d news(draw.normal(), draw.normal(), draw.normal());
    state = law.memory * state + rest * news;
    const Eigen::Vector3d error = law.inflation * state + law.bias * Eigen::Vector3d::UnitX();
    for (int c = 0; c < 3; ++c) rows.spread.mean.push_back(-0.01 * error(c));
    for (int e = 0; e < 9; ++e) rows.spread.covariance.push_back(e % 4 == 0 ? 1e-4 : 0.0);
  }
  return rows;
}

using DrawRun = std::function<RunRows(std::uint64_t study, std::uint64_t run, std::size_t scans)>;

/// Shares of studies.
struct Rejected {
  double above = 0.0;  ///< too large somewhere
  double below = 0.0;  ///< too small only
  double either() const { return above + below; }
};

/// Judges studies of `runs` runs and gives the shares of those that the test rejects.
Rejected rejected(const DrawRun& draw, Moments moments, std::size_t particles, std::uint64_t runs,
                  std::size_t scans, std::uint64_t studies) {
  std::vector<double> times;
  for (std::size_t s = 0; s < scans; ++s) times.push_back(0.2 * static_cast<double>(s + 1));
  const BandWalks walks(scans);
  RunMetrics metrics;
  Rejected found;
  for (std::uint64_t study = 0; study < studies; ++study) {
    NeesAccumulator sums(ErrorBlock::pose, moments, scans);
    for (std::uint64_t run = 0; run < runs; ++run) {
      metrics.measure(draw(study, run, scans), particles, times);
      sums.add(metrics);
    }
    const Consistency verdict = sums.result(times, 0.95, walks).consistency;
    if (is_above(verdict)) {
      found.above += 1.0;
    } else if (is_below(verdict)) {
      found.below += 1.0;
    }
  }
  const auto n = static_cast<double>(studies);
  return {found.above / n, found.below / n};
}

Rejected rejected(const Law& law, std::uint64_t runs, std::size_t scans, std::uint64_t studies) {
  const DrawRun draw = [&](std::uint64_t study, std::uint64_t run, std::size_t n) {
    return draw_run(law, study, run, n);
  };
  return rejected(draw, Moments::spread, 0, runs, scans, studies);
}

// 30 runs of 60 independent scans: the average over the run has a deviation of 0.058, so that
// errors 1.1 times too large (NEES 1.21 times) lie 11 deviations off.
TEST(VerdictPower, FindsAFilterThatIsATenthTooSure) {
  EXPECT_GE(rejected({.inflation = 1.1}, 30, 60, 40).either(), 0.975);
  EXPECT_GE(rejected({.inflation = 0.9}, 30, 60, 40).either(), 0.975);
}

TEST(VerdictPower, FindsABiasOfHalfADeviation) {
  EXPECT_GE(rejected({.bias = 0.5}, 60, 60, 40).either(), 0.975);
}

}  // namespace
}  // namespace montecarta::analysis
