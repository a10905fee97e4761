// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_filters.hpp"
#include "filters/models/range_bearing.hpp"
#include "tests/filters/default_options.hpp"

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace montecarta {
namespace {

constexpr std::size_t kSeenPerScan = 5;

/// Landmarks on a circle of 20 m around the origin, as seen from there.
std::vector<Detection> circle(std::size_t landmarks) {
  std::vector<Detection> scan;
  for (std::size_t k = 0; k < landmarks; ++k) {
    const double bearing = wrap(kTwoPi * static_cast<double>(k) / static_cast<double>(landmarks));
    scan.push_back({20.0, bearing, static_cast<std::int32_t>(k)});
  }
  return scan;
}

std::unique_ptr<SlamFilter> filter_knowing(const std::vector<Detection>& all, Association kind,
                                           const StepContext& context) {
  FilterSetup setup{.belief = {},
                    .association = {},
                    .options = default_options(ekf_slam_kind()),
                    .landmarks = all.size()};
  setup.association.kind = kind;
  auto filter = make_ekf_slam(setup);
  filter->start({});
  filter->update(context, all);
  return filter;
}

void ekf_slam_step(benchmark::State& state) {
  const StepContext context(1, 0, 0, Parallel::serial());
  const auto filter = filter_knowing(circle(35), Association::known, context);
  for (auto _ : state) filter->predict(context, {0.0, 0.1}, 0.025);
}

void ekf_slam_scan(benchmark::State& state, Association kind) {
  const StepContext context(1, 0, 0, Parallel::serial());
  const auto all = circle(static_cast<std::size_t>(state.range(0)));
  const auto filter = filter_knowing(all, kind, context);
  const Scan scan = Scan(all).first(kSeenPerScan);
  for (auto _ : state) filter->update(context, scan);
  state.counters["s/detection"] =
      benchmark::Counter(static_cast<double>(state.iterations() * kSeenPerScan),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// A bank of Gaussians that all differ.
void hrb_scan(benchmark::State& state) {
  const StepContext context(1, 0, 0, Parallel::serial());
  const auto particles = static_cast<std::size_t>(state.range(0));
  const auto all = circle(35);
  const auto filter =
      make_hrb({.belief = {},
                .association = {},
                .options = default_options(hrb_kind(), {{"particles", std::to_string(particles)},
                                                        {"split_beyond_deg", "0.1"},
                                                        {"resample_below", "0"}}),
                .landmarks = all.size()});
  filter->start({});
  filter->predict(context, {3.0, 0.1}, 0.2);
  filter->update(context, all);
  const Scan scan = Scan(all).first(kSeenPerScan);
  for (auto _ : state) filter->update(context, scan);
  state.counters["s/particle-detection"] =
      benchmark::Counter(static_cast<double>(state.iterations() * kSeenPerScan * particles),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(ekf_slam_step);
BENCHMARK(hrb_scan)->Arg(10)->Arg(30);
BENCHMARK_CAPTURE(ekf_slam_scan, known, Association::known)->Arg(35)->Arg(135);
BENCHMARK_CAPTURE(ekf_slam_scan, nearest, Association::nearest)->Arg(35)->Arg(135);

}  // namespace
}  // namespace montecarta
