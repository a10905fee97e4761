// SPDX-License-Identifier: BSD-3-Clause
// Whole drives, to show how the cost grows with their scans and landmarks.
#include "filters/joint/joint_filter.hpp"
#include "filters/smoothing/smoother.hpp"
#include "tests/filters/small_world.hpp"

#include <benchmark/benchmark.h>

#include <cmath>

namespace montecarta::filters {
namespace {

/// Laps of a circle among landmarks, of which a scan sees about six.
SmallWorld laps(std::size_t scans, std::size_t landmarks) {
  constexpr double kSeen = 6.0, kRadius = 40.0;
  const double range = kRadius * std::sqrt(2.0 * kSeen / static_cast<double>(landmarks));
  return small_world({.seed = 5, .landmarks = landmarks, .scans = scans, .max_range = range});
}

void whole_drive(benchmark::State& state, const FilterKind& kind) {
  const auto scans = static_cast<std::size_t>(state.range(0));
  const auto landmarks = static_cast<std::size_t>(state.range(1));
  const SmallWorld world = laps(scans, landmarks);
  FilterSetup setup{
      .belief = {}, .association = {}, .options = default_options(kind), .landmarks = landmarks};
  setup.association.kind = Association::known;
  const auto filter = kind.make(setup);
  for (auto _ : state) drive_through(*filter, world, Pose{}, [](std::size_t) {});
  state.counters["per_scan"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(scans),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(whole_drive, ekf_slam, ekf_slam_kind())
    ->ArgNames({"scans", "landmarks"})
    ->Args({1000, 35})
    ->Args({4000, 35})
    ->Args({4000, 135})
    ->Args({4000, 500})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole_drive, smoother, smoother_kind())
    ->ArgNames({"scans", "landmarks"})
    ->Args({1000, 35})
    ->Args({4000, 35})
    ->Args({16000, 35})
    ->Args({4000, 135})
    ->Args({4000, 500})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace montecarta::filters
