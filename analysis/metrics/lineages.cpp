// SPDX-License-Identifier: BSD-3-Clause
// Numbers of ancestors of the particles, and the Monte Carlo error that comes from few of them.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/lineage_sums.hpp"
#include "analysis/study/metric.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

template <double Lineages::*kValue>
double of_lineages(const MeasuredRun& run) {
  const Lineages* lineages = run.metrics.lineages();
  return lineages == nullptr ? kNaN : lineages->*kValue;
}

constexpr Score kLineagesScores[] = {
    {"coalescence", "s", "time back to the common ancestor", of_lineages<&Lineages::coalescence>,
     Better::higher},
    {"monte_carlo_variance", "m2", "position variance by few particles",
     of_lineages<&Lineages::monte_carlo_variance>},
};

class LineagesOverRuns final : public MergedSums<LineagesOverRuns> {
 public:
  explicit LineagesOverRuns(const RunCriteria& /*criteria*/) {}
  void add(const MeasuredRun& run) override {
    if (run.metrics.lineages() != nullptr) lineages_.add(*run.metrics.lineages());
  }
  void put(CellAnalysis& cell) override {
    if (!lineages_.empty()) cell.findings.put(lineages_.result());
  }
  static constexpr auto parts() { return std::tuple(added(&LineagesOverRuns::lineages_)); }

 private:
  LineageSums lineages_;
};

}  // namespace

Metric lineages_metric() {
  return {.scores = kLineagesScores,
          .scores_are_numbers = false,
          .sums = make_sums<LineagesOverRuns>,
          .add_numbers = numbers_by(lineage_numbers())};
}

}  // namespace montecarta::analysis
