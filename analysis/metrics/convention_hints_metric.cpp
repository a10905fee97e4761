// SPDX-License-Identifier: BSD-3-Clause
// Of imported estimates: by which other conventions of the error they would not be rejected.
#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/imported_estimates.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <optional>

namespace montecarta::analysis {
namespace {

/// Whether no family rejects it.
bool fits_errors(const Verdict& found) {
  return std::ranges::none_of(found.families, &FamilyTest::is_rejected);
}

std::string comma_joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return all;
}

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

ConventionHints::ConventionHints(std::size_t components, std::size_t scans)
    : components_(static_cast<double>(components)),
      nees_(kErrorConventions.size(), SummedError(scans)) {}

void ConventionHints::add(const std::array<std::vector<double>, kErrorConventions.size()>& nees) {
  ++runs_;
  for (std::size_t k = 0; k < nees_.size(); ++k) {
    for (std::size_t s = 0; s < nees[k].size(); ++s) nees_[k].add(s, nees[k][s], components_);
  }
}

ConventionHint ConventionHints::result(std::span<const double> times, double level,
                                       double within) const {
  ConventionHint hint;
  for (const SummedError& nees : nees_) {
    hint.by_convention.push_back(judge(nees.families(level, times), level, within, runs_));
  }
  return hint;
}

std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said) {
  std::vector<std::string> fitting, others;
  bool said_fits = false;
  for (std::size_t k = 0; k < hint.by_convention.size(); ++k) {
    const Verdict& found = hint.by_convention[k];
    if (found.answer == Answer::untested) return "";
    if (said == kErrorConventions[k].name) {
      said_fits = fits_errors(found);
    } else {
      (fits_errors(found) ? fitting : others)
          .push_back(std::string(kErrorConventions[k].name) + " (NEES ratio " +
                     compact(found.ratio_estimate()) + ")");
    }
  }
  if (fitting.empty() && others.empty()) return "";
  std::string words = cell + ": the verdict is by the error " + said + ". ";
  if (fitting.empty())
    return words + "Every other would have been rejected" + (said_fits ? ": " : " as well: ") +
           comma_joined(others);
  words += "The same covariances would not have been rejected as " + comma_joined(fitting);
  if (!others.empty()) words += ", but as " + comma_joined(others);
  return words + (said_fits ? ": this study cannot tell them apart"
                            : ": were they meant so? If not, this is by chance, and no verdict");
}

Metric convention_hints_metric() { return {.sums = make_sums<HintsOverRuns>}; }

}  // namespace montecarta::analysis
