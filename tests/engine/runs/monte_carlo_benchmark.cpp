// SPDX-License-Identifier: BSD-3-Clause
// Cost of the engine itself: a scripted study with about the arithmetic of a lap, and one with
// almost none.
#include "engine/runs/monte_carlo.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_study.hpp"

#include <benchmark/benchmark.h>

namespace montecarta::engine {
namespace {

StudyPlan study(std::uint64_t runs, std::size_t steps, std::size_t particles) {
  StudyPlan plan = scripted_study(runs, steps);
  plan.columns = {};
  plan.cells = {scripted_cell("scripted", {.particles = particles})};
  return plan;
}

RunOptions options(const ScratchFolder& folder, int threads) {
  return {.output = folder / "study.h5",
          .parallel = Parallel(Backend::tbb, threads),
          .force = true,
          .quiet = true};
}

/// Runs per second for a number of threads; compare the rows.
void study_of_laps(benchmark::State& state) {
  const ScratchFolder folder;
  const StudyPlan plan = study(40, 2000, 100);
  const RunOptions how = options(folder, static_cast<int>(state.range(0)));
  double seconds = 0.0;
  for (auto _ : state) seconds += run_study(plan, how).seconds;
  const double runs = static_cast<double>(plan.runs) * static_cast<double>(state.iterations());
  state.counters["runs_per_s"] = runs / seconds;
}
BENCHMARK(study_of_laps)
    ->Arg(1)
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// Four steps of one particle, so that the price of a task remains, file included.
void price_of_a_task(benchmark::State& state) {
  const ScratchFolder folder;
  const StudyPlan plan = study(20000, 4, 1);
  const RunOptions how = options(folder, static_cast<int>(state.range(0)));
  double seconds = 0.0;
  for (auto _ : state) seconds += run_study(plan, how).seconds;
  const double runs = static_cast<double>(plan.runs) * static_cast<double>(state.iterations());
  state.counters["us_per_run"] = 1e6 * seconds / runs;
}
BENCHMARK(price_of_a_task)
    ->Arg(1)
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace montecarta::engine
