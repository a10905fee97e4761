// SPDX-License-Identifier: BSD-3-Clause
// Tests whether the covariances of another program fit another convention of the error.
#include "analysis/verdict/convention_hints.hpp"

#include "analysis/run/measured_run.hpp"
#include "analysis/run/nees.hpp"
#include "analysis/study/metric.hpp"

#include <optional>
#include <tuple>

namespace montecarta::analysis {
namespace {

/// {scan} NEES of imported errors.
std::vector<double> nees_of(const ErrorRows& errors) {
  std::vector<double> nees;
  for (std::size_t s = 0; s < errors.scans(); ++s) {
    nees.push_back(on_full_scale(imported_nees(errors.error(s), errors.covariance_of(s)),
                                 errors.components()));
  }
  return nees;
}

class HintsOverRuns final : public MergedSums<HintsOverRuns> {
 public:
  explicit HintsOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    const ErrorRows& error = run.rows.error;
    if (error.value.empty()) return;
    if (!hints_) hints_.emplace(error.components(), criteria_->times.size());
    NeesBy<kErrorConventions.size()> by_convention = error.nees_by;
    if (by_convention.front().empty()) by_convention.front() = nees_of(error);  // of a vector
    hints_->add(by_convention, nees_by_mistake(error, criteria_->units));
    hints_->add_variances(error, criteria_->units);
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
