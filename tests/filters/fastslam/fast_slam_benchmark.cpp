// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/cpu_clock.hpp"
#include "filters/fastslam/fast_slam_filters.hpp"
#include "tests/filters/reference/fast_slam2.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <string>

// Particle-observation and particle-step costs of FastSLAM II, and of the plain Eigen reference in
// the same run: the ratio is the figure to quote. build/benchmarks --benchmark_filter=FastSlam2
namespace montecarta {
namespace {

constexpr std::size_t kSeen = 5;
constexpr std::size_t kStepsPerScan = 8;
const Control kControl{3.0, 0.05};

Belief belief() {
  return {.sigma_speed = 0.3, .sigma_steer = 0.05, .sigma_range = 0.1, .sigma_bearing = 0.02};
}

/// Five landmarks around a circling vehicle, seen without noise at every scan.
std::vector<Detection> look(const Pose& truth) {
  std::vector<Detection> scan;
  for (std::size_t k = 0; k < kSeen; ++k) {
    const double angle = kTwoPi * static_cast<double>(k) / kSeen;
    const Point landmark{100.0 * std::cos(angle), 80.0 + 100.0 * std::sin(angle)};
    const auto sight = predicted_sight(truth, landmark);
    scan.push_back({sight.range, sight.bearing, static_cast<std::int32_t>(k)});
  }
  return scan;
}

std::unique_ptr<SlamFilter> production(std::size_t particles) {
  return make_fastslam2<Lanes>({.belief = belief(),
                                .association = {},
                                .options = FilterOptions({{"particles", std::to_string(particles)},
                                                          {"resampling", "systematic"},
                                                          {"resample_below", "0.5"},
                                                          {"weights", "closed"}}),
                                .landmarks = kSeen});
}

std::unique_ptr<SlamFilter> plain(std::size_t particles) {
  const reference::FastSlamSettings settings{
      .particles = particles, .belief = belief(), .landmarks = kSeen};
  return std::make_unique<reference::FastSlam2>(settings, reference::Weight::closed);
}

/// What timing nothing takes [s]: reading the clock is a system call.
double price_of_clock() {
  double sum = 0.0;
  for (int i = 0; i < 10000; ++i) sum += CpuClock().seconds();
  return sum / 10000;
}

enum class Part { prediction, scan };

/// Drives on; only `part` is timed. Items are particle-steps or particle-observations.
void drive(benchmark::State& state, SlamFilter& filter, std::size_t particles, Part part) {
  filter.start(Pose());
  Pose truth;
  std::uint32_t step = 0;
  double seconds = 0.0;
  const double price = price_of_clock();
  const auto timed = [&](Part here, auto&& work) {
    if (here != part) return work();
    const CpuClock clock;
    work();
    seconds += clock.seconds() - price;
  };
  for (auto _ : state) {
    seconds = 0.0;
    timed(Part::prediction, [&] {
      for (std::size_t k = 0; k < kStepsPerScan; ++k) {
        const StepContext context(1, 0, step++, Parallel::serial());
        filter.predict(context, kControl, 0.025);
        benchmark::DoNotOptimize(filter.estimate());
      }
    });
    for (std::size_t k = 0; k < kStepsPerScan; ++k) truth = move(truth, kControl, 0.025, 4.0);
    const std::vector<Detection> scan = look(truth);
    const StepContext context(1, 0, step - 1, Parallel::serial());
    timed(Part::scan, [&] { filter.update(context, scan); });
    state.SetIterationTime(seconds);
  }
  const double items =
      static_cast<double>(particles * (part == Part::scan ? kSeen : kStepsPerScan));
  state.counters["ns_per_item"] = benchmark::Counter(
      items * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void FastSlam2(benchmark::State& state, std::unique_ptr<SlamFilter> (*make)(std::size_t),
               Part part) {
  const auto particles = static_cast<std::size_t>(state.range(0));
  const auto filter = make(particles);
  drive(state, *filter, particles, part);
}

BENCHMARK_CAPTURE(FastSlam2, observation, production, Part::scan)
    ->Arg(30)
    ->Arg(100)
    ->Arg(1000)
    ->UseManualTime();
BENCHMARK_CAPTURE(FastSlam2, observation_eigen, plain, Part::scan)
    ->Arg(30)
    ->Arg(100)
    ->Arg(1000)
    ->UseManualTime();
BENCHMARK_CAPTURE(FastSlam2, prediction, production, Part::prediction)
    ->Arg(30)
    ->Arg(100)
    ->Arg(1000)
    ->UseManualTime();
BENCHMARK_CAPTURE(FastSlam2, prediction_eigen, plain, Part::prediction)
    ->Arg(30)
    ->Arg(100)
    ->Arg(1000)
    ->UseManualTime();

}  // namespace
}  // namespace montecarta
