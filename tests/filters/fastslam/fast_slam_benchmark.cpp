// SPDX-License-Identifier: BSD-3-Clause
#include "engine/runs/worker.hpp"
#include "filters/factory.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/range_bearing.hpp"
#include "filters/setup/filter_setup.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

// Particle-observation and particle-step costs of the family, and of the plain filters (of
// seven dimensions and fifteen points where the filter has points) in the same run: the ratio is
// the figure to quote. All particles share one prediction, so that its cost per step does not
// grow with them. build/benchmarks --benchmark_filter='FastSlam2|UFastSlam|Srcd'
namespace montecarta::filters {
namespace {

constexpr std::size_t kSeen = 5;
constexpr std::size_t kStepsPerScan = 8;
const Control kControl{3.0, 0.05};

Belief belief() {
  return {.control = {.sigma = {0.3, 0.05}}, .sigma_range = 0.1, .sigma_bearing = 0.02};
}

/// Five landmarks around a circling vehicle, seen without noise at every scan.
std::vector<Detection> look(const Pose& truth) {
  std::vector<Detection> scan;
  for (std::size_t k = 0; k < kSeen; ++k) {
    const double angle = kTwoPi * static_cast<double>(k) / kSeen;
    const Point landmark{100.0 * std::cos(angle), 80.0 + 100.0 * std::sin(angle)};
    const auto observation = predicted_observation(truth, landmark);
    scan.push_back({observation.range, observation.bearing, static_cast<std::int32_t>(k)});
  }
  return scan;
}

/// The filter that users get by this name, with some options that are not the defaults.
std::unique_ptr<SlamFilter> production(
    const std::string& name, std::size_t particles,
    const std::map<std::string, std::string, std::less<>>& options = {}) {
  const auto kinds = filter_kinds();
  const FilterKind& kind = *std::find_if(kinds.begin(), kinds.end(),
                                         [&](const FilterKind& k) { return k.name == name; });
  std::map<std::string, std::string, std::less<>> values = options;
  for (const Parameter& option : kind.options) values.insert({option.key, *option.fallback});
  values["particles"] = std::to_string(particles);
  return kind.make({.belief = belief(),
                    .association = {},
                    .options = FilterOptions(values),
                    .landmarks = kSeen});
}

/// Seconds that reading the clock takes, which is a system call.
double price_of_clock() {
  double sum = 0.0;
  for (int i = 0; i < 10000; ++i) sum += CpuClock().seconds();
  return sum / 10000;
}

void count(benchmark::State& state, std::size_t items) {
  state.counters["per_item"] =
      benchmark::Counter(static_cast<double>(items), benchmark::Counter::kIsIterationInvariantRate |
                                                         benchmark::Counter::kInvert);
}

/// Drives far, without a scan. Items are particle-steps.
void drive(benchmark::State& state, SlamFilter& filter, std::size_t particles) {
  constexpr std::uint32_t kSteps = 1000;
  for (auto _ : state) {
    filter.start(Pose());
    for (std::uint32_t step = 0; step < kSteps; ++step)
      filter.predict(StepContext(1, 0, step, Parallel::serial()), kControl, 0.025);
  }
  count(state, particles * kSteps);
}

/// Drives from scan to scan; only scans are timed, with the step after each, in which resampling
/// takes effect. Items are particle-observations.
void observe(benchmark::State& state, SlamFilter& filter, std::size_t particles) {
  Pose truth;
  std::uint32_t step = 0;
  const auto predict = [&] {
    filter.predict(StepContext(1, 0, step++, Parallel::serial()), kControl, 0.025);
  };
  const double price = price_of_clock();
  filter.start(Pose());
  predict();
  for (auto _ : state) {
    for (std::size_t k = 1; k < kStepsPerScan; ++k) predict();
    for (std::size_t k = 0; k < kStepsPerScan; ++k) truth = move(truth, kControl, 0.025, Vehicle());
    const std::vector<Detection> scan = look(truth);
    const CpuClock clock;
    filter.update(StepContext(1, 0, step - 1, Parallel::serial()), scan);
    predict();
    state.SetIterationTime(clock.seconds() - price);
  }
  count(state, particles * kSeen);
}

enum class Part { prediction, scan };

void measure_part(benchmark::State& state, SlamFilter& filter, Part part) {
  const auto particles = static_cast<std::size_t>(state.range(0));
  part == Part::scan ? observe(state, filter, particles) : drive(state, filter, particles);
}

enum class Make { lanes, eigen };

void measure(benchmark::State& state, const std::string& name, Make make, Part part) {
  const auto particles = static_cast<std::size_t>(state.range(0));
  const auto filter = production(make == Make::lanes ? name : "plain_" + name, particles);
  measure_part(state, *filter, part);
}

void FastSlam2(benchmark::State& state, Make make, Part part) {
  measure(state, "fastslam2", make, part);
}
void UFastSlam(benchmark::State& state, Make make, Part part) {
  measure(state, "ufastslam", make, part);
}
void Srcd(benchmark::State& state, Make make, Part part) { measure(state, "srcd", make, part); }
void DeSrcd(benchmark::State& state, const char* mode, Part part) {
  const auto filter =
      production("de_srcd", static_cast<std::size_t>(state.range(0)), {{"mode", mode}});
  measure_part(state, *filter, part);
}

/// Only a part of the time of a scan is measured; the least time is of that part.
void scans(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(30)->Arg(100)->Arg(1000)->UseManualTime()->MinTime(0.05);
}
void steps(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(3)->Arg(10)->Arg(30)->Arg(100)->Arg(1000)->MinTime(0.05);
}
void few_scans(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(3)->Arg(10)->Arg(100)->UseManualTime()->MinTime(0.05);
}

BENCHMARK_CAPTURE(FastSlam2, observation, Make::lanes, Part::scan)->Apply(scans);
BENCHMARK_CAPTURE(FastSlam2, observation_eigen, Make::eigen, Part::scan)->Apply(scans);
BENCHMARK_CAPTURE(FastSlam2, prediction, Make::lanes, Part::prediction)->Apply(steps);
BENCHMARK_CAPTURE(FastSlam2, prediction_eigen, Make::eigen, Part::prediction)->Apply(steps);

BENCHMARK_CAPTURE(UFastSlam, observation, Make::lanes, Part::scan)->Apply(scans);
BENCHMARK_CAPTURE(UFastSlam, observation_eigen, Make::eigen, Part::scan)->Apply(scans);
BENCHMARK_CAPTURE(UFastSlam, prediction, Make::lanes, Part::prediction)->Apply(steps);
BENCHMARK_CAPTURE(UFastSlam, prediction_eigen, Make::eigen, Part::prediction)->Apply(steps);

BENCHMARK_CAPTURE(Srcd, observation, Make::lanes, Part::scan)->Apply(scans);
BENCHMARK_CAPTURE(Srcd, observation_eigen, Make::eigen, Part::scan)->Apply(scans);
BENCHMARK_CAPTURE(Srcd, prediction, Make::lanes, Part::prediction)->Apply(steps);
BENCHMARK_CAPTURE(Srcd, prediction_eigen, Make::eigen, Part::prediction)->Apply(steps);

BENCHMARK_CAPTURE(DeSrcd, observation, "unbiased", Part::scan)->Apply(few_scans);
BENCHMARK_CAPTURE(DeSrcd, observation_as_printed, "as_printed", Part::scan)->Apply(few_scans);
BENCHMARK_CAPTURE(DeSrcd, prediction, "unbiased", Part::prediction)->Apply(steps);

}  // namespace
}  // namespace montecarta::filters
