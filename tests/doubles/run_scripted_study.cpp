// SPDX-License-Identifier: BSD-3-Clause
// Runs a scripted study as `montecarta run` would, for tests that kill it:
// run_scripted_study OUT.h5 RUNS PACE_MICROSECONDS [--resume]
#include "engine/runs/monte_carlo.hpp"
#include "tests/doubles/scripted_study.hpp"

#include <cstdio>
#include <exception>

int main(int n_arguments, char** arguments) {
  using namespace montecarta::engine;
  try {
    const StudyPlan plan = scripted_cells(std::stoull(arguments[2]),
                                          std::chrono::microseconds(std::stol(arguments[3])));
    RunOptions options{.output = arguments[1], .parallel = Parallel(Backend::tbb, 2)};
    options.progress = ProgressStyle::none;
    options.resume = n_arguments == 5;
    return exit_code(run_study(plan, options), runs_under_scheduler());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
