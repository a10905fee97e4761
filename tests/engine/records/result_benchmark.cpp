// SPDX-License-Identifier: BSD-3-Clause
// How fast results reach the disk and come back: a lap of 8000 steps and 1000 scans with 100
// particles, 3.8 MB.
#include "engine/records/open_result.hpp"
#include "engine/records/result_file.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <benchmark/benchmark.h>

namespace montecarta::engine {
namespace {

/// One cell with the default columns; steps : scans = 8 : 1 nearly as on the benchmark world
/// (scripted: 4 : 1).
StudyPlan lap_plan(std::uint64_t runs, std::size_t steps = 8000) {
  StudyPlan plan = scripted_study(runs, steps);
  plan.columns = {};
  plan.cells = {scripted_cell("scripted_m100", {.particles = 100})};
  return plan;
}

void lay_out_file(benchmark::State& state) {
  // The time does not depend on the length of a lap, but the disk must have room for all runs.
  const StudyPlan plan = lap_plan(static_cast<std::uint64_t>(state.range(0)), 800);
  for (auto _ : state) {
    const ScratchFolder folder;
    benchmark::DoNotOptimize(
        write_at_once(folder / "out.h5", describe(plan, {}), nullptr, Existing::replace));
  }
}

void write_run(benchmark::State& state) {
  const StudyPlan plan = lap_plan(200);
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  RunRecord record(layout);
  record.mark_complete(0.0);
  Drive drive;
  plan.drives->generate(0, drive);
  const ScratchFolder folder;
  auto writer = ResultWriter::create(folder / "out.h5", plan, {}, Existing::refuse);
  std::size_t run = 0;
  for (auto _ : state) {
    writer.write_truth(run, drive);
    writer.write(0, run++, record);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * layout.bytes()));
}

void read_run(benchmark::State& state) {
  const StudyPlan plan = lap_plan(20);
  const ScratchFolder folder;
  write_result(folder / "out.h5", plan);
  const ResultFile file(folder / "out.h5");
  const StoredCell& cell = file.cells()[0];
  std::vector<double> buffer;
  std::size_t bytes = 0;
  std::size_t run = 0;
  for (auto _ : state) {
    for (const Column& column : cell.columns) {
      buffer.resize(column.elements());
      file.read(cell, column.name, run % 20, buffer);
      bytes += column.bytes();
    }
    ++run;
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(bytes));
}

void clear_and_fingerprint(benchmark::State& state) {
  const StudyPlan plan = lap_plan(1);
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  RunRecord record(layout);
  for (auto _ : state) {
    record.clear();
    benchmark::DoNotOptimize(record.fingerprint());
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * layout.bytes()));
}

BENCHMARK(lay_out_file)->Arg(1000)->Arg(100000)->Unit(benchmark::kMillisecond);
BENCHMARK(write_run)->Iterations(200)->Unit(benchmark::kMillisecond);
BENCHMARK(read_run)->Unit(benchmark::kMillisecond);
BENCHMARK(clear_and_fingerprint)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace montecarta::engine
