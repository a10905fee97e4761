// SPDX-License-Identifier: BSD-3-Clause
// Processor time of the filter, and number of factorisations that needed a fallback.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/metric.hpp"

namespace montecarta::analysis {

Metric cost_metric() {
  static constexpr Score kScores[] = {
      {"numerical_faults", "1", "factorisations answered by a fallback",
       [](const MeasuredRun& run) { return sum_of(run.rows.numerical_faults); }},
      {"cpu_seconds", "s", "processor time of a run",
       [](const MeasuredRun& run) { return run.rows.cpu_seconds; }},
  };
  return {.scores = kScores};
}

}  // namespace montecarta::analysis
