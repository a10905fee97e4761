// SPDX-License-Identifier: BSD-3-Clause
// Ancestors of the particles some time ago, and what few of them cost.
#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/lineage_sums.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/means.hpp"

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

class LineagesOverRuns final : public MetricSums {
 public:
  explicit LineagesOverRuns(const RunCriteria& /*criteria*/) {}
  void add(const MeasuredRun& run) override {
    if (run.metrics.lineages() != nullptr) lineages_.add(*run.metrics.lineages());
  }
  void put(CellAnalysis& cell) override {
    if (!lineages_.empty()) cell.findings.put(lineages_.result());
  }

 private:
  LineageSums lineages_;
};

void lineages_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const bool known = cell.find<LineageSummary>() != nullptr;
  const LineageSummary& lineages = cell.get<LineageSummary>();
  for (std::size_t lag = 0; lag < kLineageLags.size(); ++lag) {
    all.push_back({"distinct_ancestors_" + readable(kLineageLags[lag], 1) + "_s_ago", "1",
                   known ? lineages.ancestors[lag] : kNaN});
  }
  all.push_back({"coalescence", "s", known ? lineages.coalescence : kNaN});
  all.push_back({"coalesced_share", "1", known ? lineages.coalesced_share : kNaN});
  all.push_back({"monte_carlo_share", "1", known ? lineages.monte_carlo_share : kNaN});
}

}  // namespace

Metric lineages_metric() {
  return {.scores = kLineagesScores,
          .scores_are_numbers = false,
          .sums = make_sums<LineagesOverRuns>,
          .add_numbers = lineages_numbers};
}

}  // namespace montecarta::analysis
