// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/landmark_evidence.hpp"

#include <Eigen/Dense>
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

// What a landmark's candidate costs for each particle, and the plain Eigen loop in the same run.
// build/benchmarks --benchmark_filter=MapFitness
namespace montecarta::filters {
namespace {

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

void report(benchmark::State& state, std::size_t n) {
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
  report(state, n);
}

void MapFitnessPlain(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  const auto column = poses<double>(n);
  const Eigen::Matrix2d R = Eigen::Vector2d(kNoise.range, kNoise.bearing).asDiagonal();
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
  report(state, n);
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
