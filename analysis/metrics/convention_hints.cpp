// SPDX-License-Identifier: BSD-3-Clause
// Tests whether the covariances of another program fit another convention of the error.
#include "analysis/verdict/convention_hints.hpp"

#include "analysis/run/measured_run.hpp"
#include "analysis/study/metric.hpp"

#include <optional>
#include <tuple>

namespace montecarta::analysis {
namespace {

class HintsOverRuns final : public MergedSums<HintsOverRuns> {
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
    const double level = criteria_->verdict_level(cell.complete + cell.failures.size());
    cell.findings.put(hints_->result(criteria_->times, level, criteria_->within));
  }
  static constexpr auto parts() { return std::tuple(added(&HintsOverRuns::hints_)); }

 private:
  const RunCriteria* criteria_;
  std::optional<ConventionHints> hints_;
};

}  // namespace

Metric convention_hints_metric() { return {.sums = make_sums<HintsOverRuns>}; }

}  // namespace montecarta::analysis
