// SPDX-License-Identifier: BSD-3-Clause
// How many runs are not lost yet, each judged by its own NEES.
#include "analysis/metrics/cell_panels.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/statistics/means.hpp"
#include "analysis/statistics/survival.hpp"

#include <limits>

namespace montecarta::analysis {
namespace {

class SurvivalOverRuns final : public MetricSums {
 public:
  explicit SurvivalOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    const NeesRows* nees = run.metrics.leading_nees();
    if (nees == nullptr) return;
    if (dimension_ != nees->dimension[0]) {
      dimension_ = nees->dimension[0];
      run_bound_ = nees_bounds(1, dimension_, criteria_->level).upper;
    }
    std::vector<bool> above;
    for (const double value : nees->value[0]) above.push_back(value > run_bound_);
    const auto exit = first_lasting(above, kLastingScans);
    run_exits_.push_back(exit ? criteria_->times[*exit] : std::numeric_limits<double>::infinity());
  }
  void put(CellAnalysis& cell) override {
    if (run_exits_.empty()) return;
    std::vector<double> ends = run_exits_;
    for (const FailedRun& failure : cell.failures) ends.push_back(failure.time);
    cell.findings.put(survival_of(ends, criteria_->times, criteria_->level));
  }

 private:
  const RunCriteria* criteria_;
  std::size_t dimension_ = 0;
  double run_bound_ = kNaN;        ///< upper end of the band of a single run's NEES
  std::vector<double> run_exits_;  ///< [s] {run}
};

void survival_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const Survival& survival = cell.get<Survival>();
  const bool known = survival.runs > 0;
  all.push_back({"runs_lost", "1", known ? static_cast<double>(survival.lost) : kNaN});
  all.push_back({"half_lost", "s", known ? survival.median : kNaN});
  all.push_back({"half_lost_lower", "s", known ? survival.median_interval.lower : kNaN});
  all.push_back({"half_lost_upper", "s", known ? survival.median_interval.upper : kNaN});
}

void survival_series(const CellAnalysis& cell, std::vector<NamedSeries>& all) {
  const Survival& survival = cell.get<Survival>();
  if (survival.share.empty()) return;
  all.push_back({"runs_consistent", "1", survival.share});
  all.push_back({"runs_consistent_lower", "1", ends_of(survival.interval, &Interval::lower)});
  all.push_back({"runs_consistent_upper", "1", ends_of(survival.interval, &Interval::upper)});
}

Figure survival_figure(const StudyAnalysis& study) {
  Figure figure{"survival", "How long does a run stay right?", ""};
  figure.sentence =
      "Share of the runs that still know how wrong they are, each judged by its own NEES: a run is "
      "lost where that stays above the band of a single run for 5 s at 5 Hz, or where it fails. A "
      "consistent filter loses a few runs by chance.";
  const CellValues share = [](const CellAnalysis& cell) {
    return scaled(cell.get<Survival>().share, 100.0);
  };
  add_panels(
      cell_panels(study, {"runs_consistent", "runs not lost [%]", {}, {}, Scale::percent}, share),
      study.times, figure);
  return figure;
}

std::vector<Figure> survival_figures(const StudyAnalysis& study) {
  return {survival_figure(study)};
}

}  // namespace

Metric survival_metric() {
  return {.sums = make_sums<SurvivalOverRuns>,
          .add_numbers = survival_numbers,
          .add_series = survival_series,
          .figures = survival_figures};
}

}  // namespace montecarta::analysis
