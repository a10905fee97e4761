// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/simulated_drive.hpp"
#include "experiments/worlds/world.hpp"

#include <benchmark/benchmark.h>

namespace montecarta::experiments {
namespace {

/// One lap of the dense world: about 8500 steps, 1070 scans, 5 landmarks a scan.
void generate_lap(benchmark::State& state) {
  const NoiseMode noise = state.range(0) == 0 ? NoiseMode::measured_control : NoiseMode::matched;
  const SimulatedDrive source(find_world("dense_loop"), Scenario{.noise = noise}, 1);
  Drive drive;
  std::uint64_t run = 0;
  for (auto lap : state) {
    source.generate(run++, drive);
    benchmark::DoNotOptimize(drive.detections.data());
  }
}
BENCHMARK(generate_lap)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace montecarta::experiments
