// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/kernel_sums.hpp"
#include "tests/filters/marginal/kernel_clouds.hpp"

#include <Eigen/Dense>
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

// Two sums over kernels that share the exponential: nanoseconds per pair of target and kernel, by
// method and number of particles, for thin clouds (as wide as a kernel) and wide ones (30 times);
// the plain Eigen loop in the same run is what the ratio is quoted against.
// build/benchmarks --benchmark_filter=KernelSums
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

}  // namespace
}  // namespace montecarta::filters
