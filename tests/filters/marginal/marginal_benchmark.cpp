// SPDX-License-Identifier: BSD-3-Clause
// Two sums over kernels that share the exponential: nanoseconds per pair of target and kernel, by
// method and number of particles, for thin clouds (as wide as a kernel) and wide ones (30 times);
// the ratio is relative to the plain Eigen loop in the same run.
// build/benchmarks --benchmark_filter=KernelSums
// The cost of a landmark's candidate for each particle, and the plain Eigen loop in the same run.
// build/benchmarks --benchmark_filter=MapFitness
#include "filters/marginal/kernel_sums.hpp"
#include "filters/marginal/map_learning.hpp"
#include "tests/filters/marginal/kernel_clouds.hpp"

#include <Eigen/Dense>
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr double kFloor = 0.01;  // [m]

void report(benchmark::State& state, std::size_t n) {
  state.counters["per_pair"] = benchmark::Counter(
      static_cast<double>(n) * static_cast<double>(n),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void KernelSumsBy(benchmark::State& state, KernelSums method) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const KernelCloud<Lanes> cloud(n, static_cast<double>(state.range(1)), 0.3, kFloor);
  KernelSummation<Lanes, 2> summation(method, 1e-9);
  const StepContext context(1, 0, 0, Parallel::serial());
  std::vector<std::array<Lanes, 2>> logs(cloud.targets.size());
  for (auto _ : state) {
    summation.assign(cloud.kernels, {cloud.w, cloud.lambda});
    summation.sum(context, cloud.targets, logs);
    benchmark::DoNotOptimize(logs.data());
  }
  if (summation.used() != method) state.SetLabel("declined, summed directly");
  report(state, n);
}

/// Covariances factored once per kernel, as a careful author would.
void KernelSumsPlain(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const KernelCloud<double> cloud(n, static_cast<double>(state.range(1)), 0.3, kFloor);
  std::vector<std::array<double, 2>> sums(n);
  for (auto _ : state) {
    std::vector<Eigen::LLT<Eigen::Matrix3d>> factors;
    for (const auto& kernel : cloud.kernels) factors.emplace_back(symmetric(kernel.covariance));
    for (std::size_t i = 0; i < n; ++i) {
      sums[i] = {};
      for (std::size_t j = 0; j < n; ++j) {
        const Eigen::Vector3d off = boxminus(cloud.targets[i], cloud.kernels[j].mean);
        const auto& L = factors[j].matrixLLT();
        const double density = std::exp(-0.5 * factors[j].matrixL().solve(off).squaredNorm()) /
                               (L(0, 0) * L(1, 1) * L(2, 2));
        sums[i][0] += cloud.w[j] * density;
        sums[i][1] += cloud.lambda[j] * density;
      }
    }
    benchmark::DoNotOptimize(sums.data());
  }
  report(state, n);
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int width : {1, 30}) {
    for (const int n : {30, 100, 300, 1000, 3000, 10000}) benchmark->Args({n, width});
  }
  benchmark->ArgNames({"particles", "width"})->MinTime(0.05);
}

BENCHMARK(KernelSumsPlain)->Args({100, 1})->Args({1000, 1})->MinTime(0.05);
BENCHMARK_CAPTURE(KernelSumsBy, direct, KernelSums::direct)->Apply(sizes);
BENCHMARK_CAPTURE(KernelSumsBy, ifgt, KernelSums::ifgt)->Apply(sizes);

constexpr SensorNoise kNoise{0.01, 0.0004};
constexpr RangeBearing<double> kSeen{10.0, 0.6};
constexpr std::size_t kCandidates = 32;

Point candidate(std::size_t k) { return {8.0 + 0.01 * static_cast<double>(k), 6.0}; }

template <class Real>
std::vector<BasicPose<Real>> poses(std::size_t n) {
  std::vector<BasicPose<Real>> column((n + kLanesOf<Real> - 1) / kLanesOf<Real>);
  for (std::size_t i = 0; i < column.size() * kLanesOf<Real>; ++i) {
    BasicPose<Real>& pose = column[i / kLanesOf<Real>];
    set(pose.x, i % kLanesOf<Real>, 0.01 * static_cast<double>(i % 7));
    set(pose.heading, i % kLanesOf<Real>, 0.001 * static_cast<double>(i % 5));
  }
  return column;
}

void report_candidates(benchmark::State& state, std::size_t n) {
  state.counters["per_pair"] = benchmark::Counter(
      static_cast<double>(n * kCandidates),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void MapFitness(benchmark::State& state, MapObjective objective) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const auto column = poses<Lanes>(n);
  const Weights<Lanes> weights(n);
  LandmarkEvidence<Lanes> evidence;
  for (auto _ : state) {
    evidence.look(column, weights, kSeen, kNoise, objective);
    for (std::size_t k = 0; k < kCandidates; ++k)
      benchmark::DoNotOptimize(evidence.cost(candidate(k)));
  }
  report_candidates(state, n);
}

void MapFitnessPlain(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const auto column = poses<double>(n);
  const Eigen::Matrix2d R = Eigen::Vector2d(kNoise.first, kNoise.second).asDiagonal();
  const Eigen::LLT<Eigen::Matrix2d> factor(R);
  for (auto _ : state) {
    for (std::size_t k = 0; k < kCandidates; ++k) {
      double sum = 0.0;
      for (const Pose& pose : column) {
        const auto v = residual(kSeen, predicted_observation(pose, candidate(k)));
        const Eigen::Vector2d nu(v.range, v.bearing);
        sum += std::exp(-0.5 * nu.dot(factor.solve(nu))) / static_cast<double>(n);
      }
      benchmark::DoNotOptimize(-2.0 * std::log(sum));
    }
  }
  report_candidates(state, n);
}

BENCHMARK(MapFitnessPlain)->Arg(30)->Arg(100)->Arg(1000)->MinTime(0.05);
BENCHMARK_CAPTURE(MapFitness, likelihood, MapObjective::likelihood)
    ->Arg(30)
    ->Arg(100)
    ->Arg(1000)
    ->MinTime(0.05);
BENCHMARK_CAPTURE(MapFitness, squares, MapObjective::squares)
    ->Arg(30)
    ->Arg(100)
    ->Arg(1000)
    ->MinTime(0.05);

}  // namespace
}  // namespace montecarta::filters
