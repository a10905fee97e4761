// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/nees.hpp"

#include "analysis/statistics/spread.hpp"
#include "analysis/study/nees_accumulator.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <ostream>

namespace montecarta::analysis {
namespace {

TEST(Nees, EqualsTheQuadraticFormOfEachBlock) {
  RngStream draw({5, 0, 0, 0, Draw::test});
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&] { return draw.normal(); });
    const Eigen::Matrix3d P = root * root.transpose() + 0.01 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d e(draw.normal(), draw.normal(), draw.normal());
    const Eigen::Matrix2d position = P.topLeftCorner<2, 2>();
    const double expected = e.dot(P.llt().solve(e));
    EXPECT_NEAR(nees<3>(e, P).value, expected, 1e-9 * expected) << i;
    const double expected2 = e.head<2>().dot(position.llt().solve(e.head<2>()));
    EXPECT_NEAR(nees<2>(e, P).value, expected2, 1e-9 * expected2) << i;
    EXPECT_NEAR(nees<1>(e, P, 2).value, e(2) * e(2) / P(2, 2), 1e-9 * e(2) * e(2) / P(2, 2)) << i;
    EXPECT_EQ(nees<3>(e, P).rank, 3);
  }
}

// Law: it holds in any dimension, and a matrix that is no covariance has no NEES.
TEST(ImportedNees, EqualsTheQuadraticFormOrIsUnusable) {
  RngStream draw({6, 0, 0, 0, Draw::test});
  for (const Eigen::Index d : {1, 2, 6, 15}) {
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(d, d, [&] { return draw.normal(); });
    Eigen::MatrixXd P = root * root.transpose() + 0.01 * Eigen::MatrixXd::Identity(d, d);
    const Eigen::VectorXd e = Eigen::VectorXd::NullaryExpr(d, [&] { return draw.normal(); });
    const double expected = e.dot(P.llt().solve(e));
    EXPECT_NEAR(imported_nees(e, P).value, expected, 1e-9 * expected);
    EXPECT_EQ(imported_nees(e, P).rank, d);
    EXPECT_NEAR(imported_nees(1e-9 * e, 1e-18 * P).value, expected, 1e-9 * expected) << "no floor";
    EXPECT_FALSE(imported_nees(e, -P).is_usable());
    if (d == 1) continue;
    Eigen::MatrixXd indefinite = Eigen::MatrixXd::Identity(d, d);
    indefinite(0, 1) = indefinite(1, 0) = 1.0 + 1e-6;
    EXPECT_FALSE(imported_nees(e, indefinite).is_usable());
    P(0, 1) += 1e-3 * std::sqrt(P(0, 0) * P(1, 1));
    EXPECT_FALSE(imported_nees(e, P).is_usable()) << "not symmetric";
    P(0, 1) = P(1, 0) = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(imported_nees(e, P).is_usable());
  }
}

// After eight noisy steps the deviations along the axes are 14 mm, 8 mm and 0.07 mm (EQUATIONS 1).
TEST(Nees, AcceptsAThinCovariance) {
  const Eigen::Vector3d axes(0.0141, 0.0081, 7.3e-5);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.9, 0.1, 0.3, 0.2).normalized().matrix();
  const Eigen::Matrix3d P = turn * axes.cwiseAbs2().asDiagonal() * turn.transpose();
  const Nees sample = nees<3>(turn * axes, P);
  EXPECT_NEAR(sample.value, 3.0, 1e-6);
  EXPECT_EQ(sample.rank, 3);
}

TEST(Nees, IsJudgedInTheRangeOfASingularCovariance) {
  const Eigen::Vector3d forward(1.0, 2.0, 0.1), left(-2.0, 1.0, 0.05);
  const Eigen::Matrix3d line = forward * forward.transpose();
  EXPECT_EQ(nees<3>(2.0 * forward, line).rank, 1);
  EXPECT_NEAR(nees<3>(2.0 * forward, line).value, 4.0, 1e-9);
  EXPECT_EQ(nees<2>(forward, line).rank, 1);
  EXPECT_EQ(nees<1>(forward, line, 2).rank, 1);
  const Eigen::Matrix3d plane = line + left * left.transpose();
  EXPECT_EQ(nees<3>(forward - 3.0 * left, plane).rank, 2);
  EXPECT_NEAR(nees<3>(forward - 3.0 * left, plane).value, 10.0, 1e-8);
  const Eigen::Matrix3d no_heading = Eigen::Vector3d(4.0, 1.0, 0.0).asDiagonal();
  EXPECT_EQ(nees<3>({2.0, 1.0, 0.0}, no_heading).rank, 2);
  EXPECT_NEAR(nees<3>({2.0, 1.0, 0.0}, no_heading).value, 2.0, 1e-12);
}

TEST(Nees, IsLargestWhereTheCovarianceExcludesTheError) {
  const Eigen::Vector3d forward(1.0, 2.0, 0.1);
  EXPECT_EQ(nees<3>({-20.0, 20.0, 0.0}, forward * forward.transpose()).value, kLargestNees);
  EXPECT_EQ(nees<3>({1e200, 0.0, 0.0}, Eigen::Matrix3d::Identity()).value, kLargestNees);
}

// A component that is claimed to be exact has no NEES; its error is reported beside it.
TEST(Nees, LeavesOutComponentsThatAreKnownExactly) {
  const Eigen::Matrix3d no_heading = Eigen::Vector3d(4.0, 1.0, 0.0).asDiagonal();
  EXPECT_NEAR(nees<3>({2.0, 1.0, 1e-3}, no_heading).value, 2.0, 1e-12);
  EXPECT_EQ(nees<3>({1.0, 0.0, 0.0}, Eigen::Matrix3d::Zero()).rank, 0);
  std::array<double, 3> errors = {0.0, 0.0, 0.0};
  add_errors_of_exact(Eigen::Vector3d(2.0, 1.0, -1e-3), no_heading, least_pose_deviation(), errors);
  add_errors_of_exact(Eigen::Vector3d(2.0, 1.0, 1e-10), no_heading, least_pose_deviation(), errors);
  EXPECT_THAT(errors, ElementsAre(0.0, 0.0, 1e-3));
  errors = {};
  add_errors_of_exact(Eigen::Vector3d(2.0, 1.0, 1e-7), no_heading, least_pose_deviation(), errors,
                      kSingleRounding);
  EXPECT_THAT(errors, ElementsAre(0.0, 0.0, 0.0));
  WhitenedPose pose;
  whiten_pose({2.0, 1.0, 1e-3}, no_heading, pose);
  EXPECT_EQ(pose.rank, 2);
  EXPECT_TRUE(std::isnan(pose.standardised(2)));
}

// The correlation of two components may be exact while each has its own deviation.
TEST(Nees, JudgesComponentsOfASingularCovariance) {
  const Eigen::Vector3d forward(1.0, 2.0, 0.1);
  WhitenedPose pose;
  whiten_pose({2.0, 4.0, 0.1}, forward * forward.transpose(), pose);
  EXPECT_EQ(pose.rank, 0);
  EXPECT_NEAR(pose.standardised(0), 2.0, 1e-12);
  EXPECT_NEAR(pose.standardised(2), 1.0, 1e-12);
}

TEST(Nees, SaysNothingOfAnErrorThatIsKnownToBeZero) {
  const Nees sample = nees<3>(Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero());
  EXPECT_EQ(sample.rank, 0);
  EXPECT_TRUE(sample.is_usable());
  EXPECT_TRUE(std::isnan(on_full_scale(sample, 3)));
}

// STATISTICS (2.2): chi-square of two degrees of freedom becomes chi-square of three.
TEST(Nees, OfALowerRankIsPutOnTheScaleOfAllComponents) {
  EXPECT_NEAR(on_full_scale({1.386294361119891, 2}, 3), 2.365973884375338, 1e-9) << "medians";
  EXPECT_NEAR(on_full_scale({5.991464547107979, 2}, 3), 7.814727903251179, 1e-9) << "95 %";
  EXPECT_EQ(on_full_scale({1.7, 3}, 3), 1.7);
  const double last = on_full_scale({27.631021115928547, 2}, 3);  // once in a million
  EXPECT_NEAR(on_full_scale({27631.021115928547, 2}, 3), 1000.0 * last, 1e-6 * last);
}

TEST(Nees, IsUnusableWhereANumberIsMissing) {
  const Eigen::Matrix3d P = SyntheticStudy::covariance();
  EXPECT_FALSE(nees<3>({kNaN, 0.0, 0.0}, P).is_usable());
  Eigen::Matrix3d broken = P;
  broken(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(nees<3>({0.1, 0.1, 0.1}, broken).is_usable());
  EXPECT_NEAR(nees<2>({0.2, 0.0, 0.0}, broken).value, nees<2>({0.2, 0.0, 0.0}, P).value, 1e-12);
}

TEST(Nees, IsUnusableWhereACovarianceIsIndefinite) {
  const Eigen::Matrix3d P = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  EXPECT_FALSE(nees<3>({0.1, 0.1, 0.1}, P).is_usable());
  Eigen::Matrix3d beyond = Eigen::Matrix3d::Identity();
  beyond(0, 1) = beyond(1, 0) = 1.1;
  EXPECT_FALSE(nees<3>({0.1, 0.1, 0.1}, beyond).is_usable());
  Eigen::Matrix3d hidden = Eigen::Vector3d(1.0, 0.0, 1.0).asDiagonal();
  hidden(0, 1) = hidden(1, 0) = 0.5;
  EXPECT_FALSE(nees<3>({0.1, 0.0, 0.1}, hidden).is_usable());
}

// STATISTICS 4: even a perfect filter of M particles has d (M + 1) / (M - d - 2) by the spread;
// SamplerScale.SlowMakesTheNeesOfIdealSamplersChiSquare draws them.
TEST(Nees, OfAParticleCloudHasHotellingsMean) {
  EXPECT_DOUBLE_EQ(ideal_spread_nees(3, 10), 6.6);  // STATISTICS 4
  EXPECT_TRUE(std::isinf(ideal_spread_nees(3, 5)));
}

// Few particles are no fault: how often the verdict rejects a perfect sampler, for any number of
// draws and any share of the uncertainty within the particles.

constexpr std::size_t kSamplerScans = 10;

/// A filter that knows the truth's distribution but reports it by particles: Gaussians of
/// covariance `within` B about means of covariance B, of which each draws its pose.
struct Sampler {
  std::size_t draws = 10;
  double within = 0.0;
  double weight_sigma = 0.0;  ///< of the logarithms of the weights
};

/// Mean and covariance of weighted poses, as EQUATIONS 19 has them, at the end of `rows`.
Eigen::Matrix3d add_moments(const std::vector<Eigen::Vector3d>& poses,
                            const std::vector<double>& weights, const Eigen::Matrix3d& within,
                            MomentRows& rows) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < poses.size(); ++i) mean += weights[i] * poses[i];
  Eigen::Matrix3d P = within;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    P += weights[i] * (poses[i] - mean) * (poses[i] - mean).transpose();
  }
  rows.mean.insert(rows.mean.end(), mean.begin(), mean.end());
  rows.covariance.insert(rows.covariance.end(), P.data(), P.data() + 9);
  return P;
}

RunRows sampled_run(const Sampler& sampler, std::uint64_t study, std::uint64_t run) {
  RngStream draw({study, run, 0, 0, Draw::test});
  const Eigen::Matrix3d B = 0.01 * SyntheticStudy::covariance(), L = B.llt().matrixL();
  const auto point = [&](double scale) -> Eigen::Vector3d {
    return scale * (L * Eigen::Vector3d(draw.normal(), draw.normal(), draw.normal()));
  };
  RunRows rows;
  for (std::size_t s = 0; s < kSamplerScans; ++s) {
    std::vector<Eigen::Vector3d> means, poses;
    std::vector<double> weights;
    double all = 0.0;
    for (std::size_t i = 0; i < sampler.draws; ++i) {
      means.push_back(point(1.0));
      poses.push_back(means.back() + point(std::sqrt(sampler.within)));
      all += weights.emplace_back(std::exp(sampler.weight_sigma * draw.normal()));
    }
    double squares = 0.0;
    for (double& weight : weights) {
      weight /= all;
      squares += weight * weight;
    }
    rows.ess.push_back(1.0 / squares);
    add_moments(poses, weights, Eigen::Matrix3d::Zero(), rows.spread);
    if (sampler.within > 0.0) add_moments(means, weights, sampler.within * B, rows.mixture);
    const Eigen::Vector3d truth = point(std::sqrt(1.0 + sampler.within));
    rows.truth.insert(rows.truth.end(), truth.begin(), truth.end());
  }
  return rows;
}

struct JudgedSampler {
  NeesResult nees;
  Verdict verdict;
};

JudgedSampler judged_sampler(const Sampler& sampler, std::uint64_t study, std::uint64_t runs,
                             Moments moments = kMoments.front()) {
  const std::vector<double> times = scan_times(kSamplerScans, 0.2);
  RunMetrics metrics;
  NeesAccumulator sums(ErrorBlock::pose, moments, kSamplerScans);
  WholeError errors(3, kSamplerScans);
  for (std::uint64_t run = 0; run < runs; ++run) {
    metrics.measure(sampled_run(sampler, study, run), sampler.draws, times,
                    ErrorFrame::of_estimate);
    EXPECT_EQ(metrics.leading_nees(), &metrics.nees(kMoments.front()));
    sums.add(metrics);
    errors.add(metrics.whitened(), metrics.leading_nees()->value[0]);
  }
  return {sums.result(0.95), verdict_of(errors, 3, kSamplerScans, runs)};
}

/// Share of studies of 30 runs in which some family finds a fault.
double share_rejected(const Sampler& sampler, std::uint64_t studies) {
  return share_of_studies(studies, [&](std::uint64_t study) {
    return is_rejected(judged_sampler(sampler, study, 30).verdict);
  });
}

void PrintTo(const Sampler& sampler, std::ostream* out) {
  *out << sampler.draws << " draws, within / between " << sampler.within;
}

class SlowSamplerLevel : public testing::TestWithParam<Sampler> {};

TEST_P(SlowSamplerLevel, IsAtMostFivePercent) {
  const Sampler& sampler = GetParam();
  const std::uint64_t studies = studies_of_a_line(400);
  const double found = share_rejected(sampler, studies);
  EXPECT_LT(found, 0.05 + share_errors(0.05, studies));
  RecordProperty("rejected", std::to_string(found));
}

bool is_sample_of_levels(const Sampler& sampler) {
  return sampler.within == (sampler.draws == 10 ? 0.1 : sampler.draws == 30 ? 1.0 : 0.0);
}

INSTANTIATE_TEST_SUITE_P(Of, SlowSamplerLevel,
                         testing::ValuesIn(tested_lines(
                             std::vector{Sampler{10, 0.0}, Sampler{10, 0.1}, Sampler{10, 1.0},
                                         Sampler{30, 0.0}, Sampler{30, 0.1}, Sampler{30, 1.0},
                                         Sampler{100, 0.0}, Sampler{100, 0.1}, Sampler{100, 1.0}},
                             is_sample_of_levels)));

// The corrected spread leads instead of a mixture with a tenth of its covariance in the particles.
TEST(SamplerLevel, IsNotThatOfTheMixtureAsItIs) {
  for (const std::size_t draws : {10u, 30u}) {
    const JudgedSampler found =
        judged_sampler({.draws = draws, .within = 0.1}, 1, 100, Moments::mixture);
    EXPECT_GT(found.nees.mean, draws == 10 ? 5.0 : 3.4);
  }
}

// Three draws have no covariance of three components.
TEST(SamplerLevel, JudgesNothingByThreeDrawsAndCountsThem) {
  for (const double within : {0.0, 0.1, 1.0}) {
    const JudgedSampler found = judged_sampler({.draws = 3, .within = within}, 1, 20);
    EXPECT_EQ(found.verdict.answer, Answer::untested);
    EXPECT_EQ(found.nees.series.too_few, 20 * kSamplerScans);
    EXPECT_EQ(found.nees.series.unusable, 0u);
  }
}

// Thousand runs of ten scans: a mean of 10,000 chi-squares has a standard error of 0.025.
TEST(SamplerLevel, SlowKnowsThatUnevenWeightsAreFewerDraws) {
  for (const double sigma : {0.5, 1.0}) {
    const JudgedSampler found =
        judged_sampler({.draws = 100, .within = 0.1, .weight_sigma = sigma}, 2, 1000);
    EXPECT_NEAR(found.nees.mean, 3.0, 0.06 + 5 * 0.025) << sigma;
  }
}

// The components of ten draws are Student variables, and the squares of all three together are
// Hotelling's: both are put on the normal scale. 5 standard errors of 20,000 samples.
TEST(SamplerLevel, MakesErrorsOfDrawnPosesNormal) {
  const std::vector<double> times = scan_times(kSamplerScans, 0.2);
  RunMetrics metrics;
  std::array<double, 3> squares{};
  double all = 0.0;
  for (std::uint64_t run = 0; run < 2000; ++run) {
    metrics.measure(sampled_run({.draws = 10, .within = 0.1}, 4, run), 10, times,
                    ErrorFrame::of_estimate);
    const WhitenedRun& errors = metrics.whitened();
    for (std::size_t i = 0; i < errors.standardised.size(); ++i) {
      squares[i % 3] += errors.standardised[i] * errors.standardised[i] / 20'000.0;
      all += errors.whitened[i] * errors.whitened[i] / 20'000.0;
    }
  }
  for (const double square : squares) EXPECT_NEAR(square, 1.0, 5.0 * std::sqrt(2.0 / 20'000.0));
  EXPECT_NEAR(all, 3.0, 5.0 * std::sqrt(6.0 / 20'000.0));
}

// A hundred draws of a tenth of the truth's covariance.
TEST(SamplerLevel, KeepsHowManyTimesTheCovarianceIsTooSmall) {
  const std::vector<double> times = scan_times(kSamplerScans, 0.2);
  RunMetrics metrics;
  double sum = 0.0;
  for (std::uint64_t run = 0; run < 200; ++run) {
    RunRows rows = sampled_run({.draws = 100}, 3, run);
    for (double& element : rows.spread.covariance) element *= 1e-4;
    metrics.measure(rows, 100, times, ErrorFrame::of_estimate);
    for (const double nees : metrics.leading_nees()->value[0])
      sum += nees / (200.0 * kSamplerScans);
  }
  EXPECT_NEAR(sum / 3e4, 0.85, 0.15);
}

}  // namespace
}  // namespace montecarta::analysis
