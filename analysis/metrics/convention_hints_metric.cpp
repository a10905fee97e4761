// SPDX-License-Identifier: BSD-3-Clause
// Of imported estimates: by which other conventions of the error they would not be rejected.
#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/convention_hints.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"

#include <optional>

namespace montecarta::analysis {
namespace {

class HintsOverRuns final : public MetricSums {
 public:
  explicit HintsOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    const ErrorRows& error = run.rows.error;
    if (error.nees_by.front().empty()) return;
    if (!hints_) hints_.emplace(error.components(), criteria_->times.size());
    hints_->add(error.nees_by);
  }
  void put(CellAnalysis& cell) override {
    if (!hints_) return;
    cell.findings.put(hints_->result(criteria_->times, criteria_->verdict_level(), criteria_->walks,
                                     criteria_->within));
  }

 private:
  const RunCriteria* criteria_;
  std::optional<ConventionHints> hints_;
};

}  // namespace

Metric convention_hints_metric() { return {.sums = make_sums<HintsOverRuns>}; }

}  // namespace montecarta::analysis
