// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/stream.hpp"
#include "filters/marginal/kernel_sums.hpp"
#include "filters/marginal/shared_map.hpp"
#include "filters/moments/gaussians.hpp"
#include "tests/filters/marginal/kernel_clouds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

// EQUATIONS (12.4): the weights of the auxiliary marginal filter.
namespace montecarta::filters {
namespace {

const StepContext kContext(1, 0, 0, Parallel::serial());

Weights<double> weights_of(const std::vector<double>& linear) {
  Weights<double> weights(linear.size());
  for (std::size_t i = 0; i < linear.size(); ++i) weights.multiply(i, std::log(linear[i]));
  weights.normalise(kContext);
  return weights;
}

/// log of the factor by which each particle's weight differs from its likelihood.
std::vector<double> log_ratios(const KernelCloud<double>& cloud, const MarginalSettings& settings) {
  KernelRatios<double> ratios(settings);
  ratios.assign(cloud.kernels, cloud.kernels, weights_of(cloud.w), weights_of(cloud.lambda));
  Weights<double> weights(cloud.w.size());
  ratios.multiply(kContext, cloud.targets, weights);
  std::vector<double> logs;
  for (const double log : weights.log_scalars())
    logs.push_back(log + std::log(static_cast<double>(cloud.w.size())));
  return logs;
}

MarginalSettings settings_for(const KernelCloud<double>& cloud, Choice choice) {
  return {.particles = cloud.w.size(), .choice = choice, .kernel_sums = KernelSums::direct};
}

TEST(AuxiliaryWeights, AreTheLikelihoodWhereKernelsAreChosenByWeight) {
  KernelCloud<double> cloud(40, 2.0, 0.3, 0.01);
  cloud.lambda = cloud.w;
  for (const Choice choice : {Choice::by_weight, Choice::by_likelihood}) {
    for (const double log : log_ratios(cloud, settings_for(cloud, choice))) EXPECT_EQ(log, 0.0);
  }
}

TEST(AuxiliaryWeights, AreThoseOfTheAuxiliaryFilterWhereKernelsDoNotOverlap) {
  const KernelCloud<double> cloud(30, 1e5, 0.3, 0.001);
  const auto logs = log_ratios(cloud, settings_for(cloud, Choice::by_likelihood));
  for (std::size_t i = 0; i < 30; ++i)
    EXPECT_NEAR(logs[i], std::log(cloud.w[i] / cloud.lambda[i]), 1e-9);
}

TEST(AuxiliaryWeights, OfASingleParticleIsOne) {
  const KernelCloud<double> cloud(1, 1.0, 0.3, 0.01);
  EXPECT_EQ(log_ratios(cloud, settings_for(cloud, Choice::by_likelihood))[0], 0.0);
}

/// log N(x; 0, variance).
double log_normal(double x, double variance) {
  return -0.5 * (x * x / variance + std::log(kTwoPi * variance));
}

/// Five kernels on a line; the sensor sees x. Headings and y are drawn, and make no difference.
struct Line {
  static constexpr double kVariance = 0.09, kNoise = 0.04, kSeen = 0.7;
  std::vector<PoseGaussian<double>> kernels;
  std::vector<double> w{0.1, 0.3, 0.2, 0.15, 0.25}, lambda;

  Line() {
    double sum = 0.0;
    for (std::size_t j = 0; j < w.size(); ++j) {
      kernels.push_back({{0.4 * static_cast<double>(j) - 0.5, 0.0, 0.0},
                         {.xx = kVariance, .yy = 1.0, .hh = 0.01}});
      lambda.push_back(w[j] * std::exp(log_normal(kSeen - kernels[j].mean.x, kNoise)));
      sum += lambda[j];
    }
    for (double& l : lambda) l /= sum;
  }
  /// Sum_j w_j Integral p(z | s) p(s | s_j) ds.
  double evidence() const {
    double sum = 0.0;
    for (std::size_t j = 0; j < w.size(); ++j)
      sum += w[j] * std::exp(log_normal(kSeen - kernels[j].mean.x, kVariance + kNoise));
    return sum;
  }
  std::size_t choose(double uniform) const {
    std::size_t j = 0;
    for (; j + 1 < lambda.size() && uniform >= lambda[j]; ++j) uniform -= lambda[j];
    return j;
  }
};

// n = 1e6 draws; the tolerance is five standard errors of the mean that the draws show.
TEST(AuxiliaryWeights, AverageToTheEvidenceOfTheScan) {
  const Line line;
  KernelSummation<Lanes, 2> summation(KernelSums::direct, 1e-9);
  const std::vector<PoseGaussian<Lanes>> block = [&] {
    std::vector<PoseGaussian<Lanes>> one(1);
    double* to = reinterpret_cast<double*>(one.data());
    for (std::size_t f = 0; f < 9; ++f) {
      for (std::size_t j = 0; j < Lanes::kSize; ++j)
        to[f * Lanes::kSize + j] = (&line.kernels[j % 5].mean.x)[f];
    }
    return one;
  }();
  summation.assign(block, {line.w, line.lambda});
  constexpr std::uint32_t kBlocks = 125'000;
  std::vector<BasicPose<Lanes>> targets(kBlocks);
  for (std::uint32_t b = 0; b < kBlocks; ++b) {
    const StreamIdentity identity{7, 0, 0, 8 * b, Draw::test};
    const Lanes chance = uniform_pairs(identity, 0, Lanes()).first;
    PoseGaussian<Lanes> chosen = block[0];
    for (std::size_t l = 0; l < Lanes::kSize; ++l)
      set(chosen.mean.x, l, line.kernels[line.choose(get(chance, l))].mean.x);
    targets[b] = draw_from(PoseFactor<Lanes>(chosen), {7, 0, 1, 8 * b, Draw::test});
  }
  std::vector<std::array<Lanes, 2>> logs(kBlocks);
  summation.sum(kContext, targets, logs);
  double sum = 0.0, squares = 0.0;
  for (std::uint32_t b = 0; b < kBlocks; ++b) {
    for (std::size_t l = 0; l < Lanes::kSize; ++l) {
      const double likelihood = log_normal(Line::kSeen - get(targets[b].x, l), Line::kNoise);
      const double weight = std::exp(likelihood + get(logs[b][0], l) - get(logs[b][1], l));
      sum += weight, squares += weight * weight;
    }
  }
  const double n = 8.0 * kBlocks, mean = sum / n;
  const double standard_error = std::sqrt((squares / n - mean * mean) / n);
  EXPECT_LT(standard_error, 0.002 * mean) << "the test has become blunt";
  EXPECT_NEAR(mean, line.evidence(), 5.0 * standard_error);
}

TEST(SharedLikelihood, LeavesOutALandmarkThatAPoseStandsOn) {
  SharedLikelihood<double> likelihood({0.01, 0.0004}, MapMode::recursive);
  const SharedMap map{{{3.0, 4.0}, {100.0, 0.0, 100.0}}};
  likelihood.see({{0, {5.0, 0.0}}}, map);
  EXPECT_EQ(likelihood.at({3.0, 4.0, 0.0}).faults, 1.0);
  EXPECT_EQ(likelihood.at({3.0, 4.0, 0.0}).log_weight, 0.0);
  EXPECT_EQ(likelihood.at({0.0, 0.0, 0.9}).faults, 0.0);
}

TEST(SharedLikelihood, KnowsTheMapsCovarianceOnlyWhereTheMapRemembers) {
  const SharedMap map{{{5.0, 0.0}, {100.0, 0.0, 100.0}}};  // sigma 0.1 m
  SharedLikelihood<double> exact({0.01, 0.0004}, MapMode::onestep_converged);
  SharedLikelihood<double> uncertain({0.01, 0.0004}, MapMode::recursive);
  exact.see({{0, {5.0, 0.0}}}, map);
  uncertain.see({{0, {5.0, 0.0}}}, map);
  const double S = 0.02 * (0.0004 + 0.01 / 25.0), R = 0.01 * 0.0004;
  EXPECT_NEAR(exact.at({}).log_weight, -std::log(kTwoPi) - 0.5 * std::log(R), 1e-12);
  EXPECT_NEAR(uncertain.at({}).log_weight, -std::log(kTwoPi) - 0.5 * std::log(S), 1e-12);
}

}  // namespace
}  // namespace montecarta::filters
