// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/cpu_clock.hpp"
#include "filters/factory.hpp"
#include "tests/filters/reference/srcd_fast_slam.hpp"
#include "tests/filters/reference/ufast_slam.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <string>

// Particle-observation and particle-step costs of the family, and of the plain Eigen references (of
// seven dimensions and fifteen points where the filter has points) in the same run: the ratio is
// the figure to quote. build/benchmarks --benchmark_filter='FastSlam2|UFastSlam|Srcd|Delayed'
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

/// As users get it, by name.
std::unique_ptr<SlamFilter> production(const char* name, std::size_t particles) {
  const auto kinds = filter_kinds();
  const FilterKind& kind = *std::find_if(kinds.begin(), kinds.end(),
                                         [&](const FilterKind& k) { return k.name == name; });
  std::map<std::string, std::string, std::less<>> values;
  for (const FilterOption& option : kind.options) values[option.name] = option.fallback;
  values["particles"] = std::to_string(particles);
  return kind.make({.belief = belief(),
                    .association = {},
                    .options = FilterOptions(values),
                    .landmarks = kSeen});
}

std::unique_ptr<SlamFilter> plain(const std::string& name, std::size_t particles) {
  const reference::FastSlamSettings settings{
      .particles = particles, .belief = belief(), .landmarks = kSeen};
  constexpr auto kWeight = reference::Weight::closed;
  if (name == "ufastslam")
    return std::make_unique<reference::UFastSlam>(settings, kWeight, reference::Unscented{}, true);
  if (name == "srcd")
    return std::make_unique<reference::SrcdFastSlam>(settings, kWeight, reference::SrcdParts{});
  return std::make_unique<reference::FastSlam2>(settings, kWeight);
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
    for (std::size_t k = 0; k < kStepsPerScan; ++k) truth = move(truth, kControl, 0.025, Vehicle());
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

enum class Make { lanes, eigen };

void measure(benchmark::State& state, const char* name, Make make, Part part) {
  const auto particles = static_cast<std::size_t>(state.range(0));
  const auto filter = make == Make::lanes ? production(name, particles) : plain(name, particles);
  drive(state, *filter, particles, part);
}

void FastSlam2(benchmark::State& state, Make make, Part part) {
  measure(state, "fastslam2", make, part);
}
void UFastSlam(benchmark::State& state, Make make, Part part) {
  measure(state, "ufastslam", make, part);
}
void Srcd(benchmark::State& state, Make make, Part part) { measure(state, "srcd", make, part); }
void DeSrcd(benchmark::State& state, Make make, Part part) {
  measure(state, "de_srcd", make, part);
}

void Delayed(benchmark::State& state, Make make, Part part) {
  measure(state, "delayed", make, part);
}

/// Only a part of the time is measured, a twentieth or less: the least time is of that part.
void take(benchmark::internal::Benchmark* benchmark, std::initializer_list<std::int64_t> sizes) {
  for (const std::int64_t particles : sizes) benchmark->Arg(particles);
  benchmark->UseManualTime()->MinTime(0.05);
}
void sizes(benchmark::internal::Benchmark* benchmark) { take(benchmark, {30, 100, 1000}); }
void few(benchmark::internal::Benchmark* benchmark) { take(benchmark, {3, 10, 100}); }

BENCHMARK_CAPTURE(FastSlam2, observation, Make::lanes, Part::scan)->Apply(sizes);
BENCHMARK_CAPTURE(FastSlam2, observation_eigen, Make::eigen, Part::scan)->Apply(sizes);
BENCHMARK_CAPTURE(FastSlam2, prediction, Make::lanes, Part::prediction)->Apply(sizes);
BENCHMARK_CAPTURE(FastSlam2, prediction_eigen, Make::eigen, Part::prediction)->Apply(sizes);

BENCHMARK_CAPTURE(UFastSlam, observation, Make::lanes, Part::scan)->Apply(sizes);
BENCHMARK_CAPTURE(UFastSlam, observation_eigen, Make::eigen, Part::scan)->Apply(sizes);
BENCHMARK_CAPTURE(UFastSlam, prediction, Make::lanes, Part::prediction)->Apply(sizes);
BENCHMARK_CAPTURE(UFastSlam, prediction_eigen, Make::eigen, Part::prediction)->Apply(sizes);

BENCHMARK_CAPTURE(Srcd, observation, Make::lanes, Part::scan)->Apply(sizes);
BENCHMARK_CAPTURE(Srcd, observation_eigen, Make::eigen, Part::scan)->Apply(sizes);
BENCHMARK_CAPTURE(Srcd, prediction, Make::lanes, Part::prediction)->Apply(sizes);
BENCHMARK_CAPTURE(Srcd, prediction_eigen, Make::eigen, Part::prediction)->Apply(sizes);

BENCHMARK_CAPTURE(DeSrcd, observation, Make::lanes, Part::scan)->Apply(few);
BENCHMARK_CAPTURE(DeSrcd, prediction, Make::lanes, Part::prediction)->Apply(few);

BENCHMARK_CAPTURE(Delayed, observation, Make::lanes, Part::scan)->Apply(sizes);

}  // namespace
}  // namespace montecarta
