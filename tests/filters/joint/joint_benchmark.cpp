// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/stream.hpp"
#include "filters/joint/joint_filter.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/range_bearing.hpp"
#include "tests/filters/small_world.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::filters {
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
  state.counters["per_detection"] =
      benchmark::Counter(static_cast<double>(state.iterations() * kSeenPerScan),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// A ring road of such a radius [m] that a scan up to 30 m ahead shows seven landmarks.
struct RingRoad {
  explicit RingRoad(std::size_t n) : radius(static_cast<double>(n) / 1.88) {
    for (std::uint32_t k = 0; k < n; ++k) {
      RngStream draw({.index = k, .purpose = Draw::world_landmark});
      const double angle = kTwoPi * draw.uniform(), r = radius - 30.0 + 60.0 * draw.uniform();
      landmarks.push_back({r * std::cos(angle), radius + r * std::sin(angle)});
    }
  }

  std::vector<Detection> scan(const Pose& pose, std::uint32_t step) const {
    std::vector<Detection> all;
    for (std::uint32_t k = 0; k < landmarks.size(); ++k) {
      const auto observation = predicted_observation(pose, landmarks[k]);
      if (observation.range > 30.0 || std::abs(observation.bearing) > kPi / 2.0) continue;
      RngStream draw({.step = step, .index = k, .purpose = Draw::world_detection});
      all.push_back({observation.range + 0.1 * draw.normal(),
                     wrap(observation.bearing + 0.02 * draw.normal()),
                     static_cast<std::int32_t>(k)});
    }
    return all;
  }

  double radius;
  std::vector<Point> landmarks;
};

/// Drives `filter` along the road by `way` [m] between scans, `scans` times. Scans are taken ahead
/// of time, so that only the filter is timed; `around` says whether to go on.
template <class Around>
void drive(SlamFilter& filter, const RingRoad& road, double way, std::size_t scans, Pose& pose,
           const Around& around) {
  const Belief belief;
  const Control control{way / 0.2,
                        std::asin(std::get<Car>(belief.vehicle).wheelbase / road.radius)};
  std::vector<std::vector<Detection>> seen;
  for (std::uint32_t s = 0; s < scans; ++s) {
    for (int step = 0; step < 8; ++step) {
      pose = move(pose, control, 0.025, belief.vehicle);
    }
    seen.push_back(road.scan(pose, s));
  }
  for (std::uint32_t s = 0; s < scans && around(); ++s) {
    const StepContext context(1, 0, s, Parallel::serial());
    for (int step = 0; step < 8; ++step) filter.predict(context, control, 0.025);
    filter.update(context, seen[s]);
  }
}

/// A scan on a second round, of a map that the first round has made.
void second_round(benchmark::State& state, const FilterKind& kind, Association association,
                  const std::vector<std::pair<std::string, std::string>>& given) {
  const RingRoad road(static_cast<std::size_t>(state.range(0)));
  std::map<std::string, std::string, std::less<>> options(given.begin(), given.end());
  FilterSetup setup{.belief = {},
                    .association = {.kind = Association::known},
                    .options = default_options(kind, options),
                    .landmarks = road.landmarks.size()};
  setup.association.kind = association;
  const auto filter = kind.make(setup);
  const auto round = static_cast<std::size_t>(kTwoPi * road.radius / 12.0);
  Pose pose;
  filter->start(pose);
  drive(*filter, road, 12.0, round + 2, pose, [] { return true; });
  drive(*filter, road, 0.6, static_cast<std::size_t>(state.max_iterations) + 1, pose,
        [&] { return state.KeepRunning(); });
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(35)->Arg(135)->Arg(500)->Iterations(200)->Unit(benchmark::kMicrosecond);
}

void sizes_of_one(benchmark::internal::Benchmark* benchmark) { sizes(benchmark->Arg(2000)); }

BENCHMARK_CAPTURE(second_round, ekf_slam, ekf_slam_kind(), Association::known, {})
    ->Apply(sizes_of_one);
BENCHMARK_CAPTURE(second_round, riekf_slam, riekf_slam_kind(), Association::known, {})
    ->Apply(sizes_of_one);
BENCHMARK_CAPTURE(second_round, ekf_slam_nearest, ekf_slam_kind(), Association::nearest, {})
    ->Apply(sizes);
BENCHMARK(ekf_slam_step);
BENCHMARK_CAPTURE(ekf_slam_scan, known, Association::known)->Arg(35)->Arg(135);
BENCHMARK_CAPTURE(ekf_slam_scan, nearest, Association::nearest)->Arg(35)->Arg(135);

}  // namespace
}  // namespace montecarta::filters
