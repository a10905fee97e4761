// SPDX-License-Identifier: BSD-3-Clause
// How many runs are not lost yet, each judged by its own NEES.
#include "analysis/metrics/survival.hpp"

#include "analysis/metrics/cell_report.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/statistics/spread.hpp"

#include <boost/math/distributions/normal.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

/// Where a probability lies of which `hits` of `n` were seen.
Interval wilson(double hits, double n, double level) {
  const double z = boost::math::quantile(boost::math::normal(), 0.5 + 0.5 * level);
  const double share = hits / n, scale = 1.0 + z * z / n;
  const double middle = (share + 0.5 * z * z / n) / scale;
  const double half = z * std::sqrt(share * (1.0 - share) / n + 0.25 * z * z / (n * n)) / scale;
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

class SurvivalOverRuns final : public MergedSums<SurvivalOverRuns> {
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
    run_exits_.push_back(exit ? run.times[*exit] : std::numeric_limits<double>::infinity());
  }
  void put(CellAnalysis& cell) override {
    if (run_exits_.empty()) return;
    std::vector<double> ends = run_exits_;
    for (const FailedRun& failure : cell.failures) ends.push_back(failure.time);
    cell.findings.put(survival_of(ends, criteria_->times, criteria_->level));
  }
  static constexpr auto parts() { return std::tuple(appended(&SurvivalOverRuns::run_exits_)); }

 private:
  const RunCriteria* criteria_;
  std::size_t dimension_ = 0;
  double run_bound_ = kNaN;        ///< upper end of the band of a single run's NEES
  std::vector<double> run_exits_;  ///< [s] {run}
};

const std::vector<ResultNumber<Survival>> kSurvivalQuantities = {
    {"runs_lost", "1", [](const Survival& found) { return static_cast<double>(found.lost); }},
    {"half_lost", "s", &Survival::median, {}, {}, &Survival::median_interval}};

void survival_series(const CellAnalysis& cell, std::vector<Frame::Column>& all) {
  const Survival& survival = cell.get<Survival>();
  if (survival.share.empty()) return;
  all.push_back({"runs_consistent", "1", survival.share});
  all.push_back({"runs_consistent_lower", "1", ends_of(survival.interval, &Interval::lower)});
  all.push_back({"runs_consistent_upper", "1", ends_of(survival.interval, &Interval::upper)});
}

std::vector<Figure> survival_figures(const StudyAnalysis& study) {
  return {cell_figure(
      study, figure_of("survival", {{"lasting", std::to_string(kLastingScans)}}),
      {"runs_consistent", "runs not lost [%]", {}, {}, Scale::percent},
      [](const CellAnalysis& cell) { return scaled(cell.get<Survival>().share, 100.0); })};
}

/// The heading of the figure.
std::vector<Section> survival_sections(const StudyAnalysis& study) {
  const CellNumber median = [](const CellAnalysis& cell) { return cell.get<Survival>().median; };
  const NumberText time = [](double seconds) {
    return std::isinf(seconds) ? "never" : fixed_seconds(seconds);
  };
  return {section_of("survival", {{"time", range_over_cells(study, median, time)}})};
}

}  // namespace

std::optional<std::size_t> first_lasting(const std::vector<bool>& above, std::size_t length) {
  std::size_t in_a_row = 0;
  for (std::size_t s = 0; s < above.size(); ++s) {
    in_a_row = above[s] ? in_a_row + 1 : 0;
    if (in_a_row == length) return s + 1 - length;
  }
  return std::nullopt;
}

Survival survival_of(std::span<const double> ends, std::span<const double> times, double level) {
  Survival survival;
  survival.runs = ends.size();
  if (ends.empty()) return survival;
  std::vector<double> sorted(ends.begin(), ends.end());
  std::ranges::sort(sorted);
  const auto n = static_cast<double>(sorted.size());
  for (const double time : times) {
    const auto left = static_cast<double>(sorted.end() - std::ranges::upper_bound(sorted, time));
    survival.share.push_back(left / n);
    survival.interval.push_back(wilson(left, n, level));
  }
  survival.lost = static_cast<std::size_t>(
      std::ranges::count_if(sorted, [](double end) { return std::isfinite(end); }));
  survival.median = sorted[(sorted.size() - 1) / 2];
  survival.median_interval = median_interval(sorted, level);
  return survival;
}

Metric survival_metric() {
  return {.sums = make_sums<SurvivalOverRuns>,
          .add_numbers = numbers_by(kSurvivalQuantities),
          .add_series = survival_series,
          .sections = survival_sections,
          .figures = survival_figures};
}

}  // namespace montecarta::analysis
