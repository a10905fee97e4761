// SPDX-License-Identifier: BSD-3-Clause
// NEES of the pose and its parts: what the verdict is made of.
#include "analysis/metrics/cell_panels.hpp"
#include "analysis/metrics/cramer_rao.hpp"
#include "analysis/metrics/imported_estimates.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/nees_accumulator.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/means.hpp"

#include <set>

namespace montecarta::analysis {
namespace {

/// Mean over the scans of a run, by its leading moments.
double mean_nees(const MeasuredRun& run, ErrorBlock block) {
  const NeesRows* nees = run.metrics.leading_nees();
  return nees == nullptr ? kNaN : mean_of_finite(nees->value[static_cast<std::size_t>(block)]);
}

constexpr Score kNeesScores[] = {
    {"nees", "1", "mean NEES of the pose",
     [](const MeasuredRun& run) { return mean_nees(run, ErrorBlock::pose); }, Better::neither},
    {"nees_position", "1", "mean NEES of the position",
     [](const MeasuredRun& run) { return mean_nees(run, ErrorBlock::position); }, Better::neither},
    {"nees_distance", "1", "NEES distance from consistency [doublings]",
     [](const MeasuredRun& run) {
       const NeesRows* nees = run.metrics.leading_nees();
       return nees_distance(mean_nees(run, ErrorBlock::pose),
                            nees == nullptr ? 3 : nees->dimension[0]);
     },
     Better::neither},
};

class NeesOverRuns final : public MetricSums {
 public:
  explicit NeesOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    if (is_first_) begin(run.metrics);
    is_first_ = false;
    for (NeesAccumulator& nees : nees_) nees.add(run.metrics);
  }
  void put(CellAnalysis& cell) override {
    if (!nees_.empty()) cell.leading = nees_.front().moments();
    for (const NeesAccumulator& nees : nees_) {
      cell.nees.push_back(nees.result(criteria_->times, criteria_->level, criteria_->walks,
                                      criteria_->within, criteria_->look_level));
    }
  }

 private:
  /// All runs of a cell have the same moments.
  void begin(const RunMetrics& metrics) {
    for (const Moments moments : kMoments) {
      if (metrics.nees(moments).value[0].empty()) continue;
      for (const ErrorBlock block : kErrorBlocks) {
        const auto b = static_cast<std::size_t>(block);
        if (metrics.nees(moments).value[b].empty()) continue;
        nees_.emplace_back(block, moments, criteria_->times.size(),
                           metrics.nees(moments).dimension[b]);
      }
    }
  }

  const RunCriteria* criteria_;
  bool is_first_ = true;
  std::vector<NeesAccumulator> nees_;  ///< leading first
};

void add_nees(const NeesResult& nees, std::vector<NamedSeries>& all) {
  const NeesSeries& series = nees.series;
  const std::string suffix = "_" + name_of(nees.block) + "_" + name_of(nees.moments);
  all.push_back({"anees" + suffix, "1", series.average});
  all.push_back({"median_nees" + suffix, "1", series.median});
  all.push_back({"lower" + suffix, "1", ends_of(series.bounds, &Interval::lower)});
  all.push_back({"upper" + suffix, "1", ends_of(series.bounds, &Interval::upper)});
  all.push_back({"trimmed_nees" + suffix, "1", series.trimmed});
  all.push_back(
      {"whole_run_lower" + suffix, "1", ends_of(series.whole_run_bounds, &Interval::lower)});
  all.push_back(
      {"whole_run_upper" + suffix, "1", ends_of(series.whole_run_bounds, &Interval::upper)});
  all.push_back({"runs" + suffix, "1", {series.runs.begin(), series.runs.end()}});
}

void nees_series(const CellAnalysis& cell, std::vector<NamedSeries>& all) {
  for (const NeesResult& nees : cell.nees) add_nees(nees, all);
}

/// One band for each number of complete runs among the cells that are tested.
std::vector<Band> bands(const StudyAnalysis& study, std::size_t dimension) {
  std::set<std::size_t> runs;
  for (const CellAnalysis& cell : study.cells) {
    if (!cell.nees.empty()) runs.insert(cell.complete);
  }
  std::vector<Band> found;
  for (const std::size_t n : runs) {
    const Interval band = nees_bounds(n, dimension, study.level);
    found.push_back(
        {found.empty() ? level_text(study.level) + " band" : "", band.lower, band.upper});
  }
  return found;
}

Panel anees_panel(const StudyAnalysis& study, ErrorBlock block, const std::string& name,
                  const std::string& label) {
  Panel panel{name, label, {}, {}, Scale::automatic};
  std::size_t dimension = 0;
  panel.curves = cell_curves(study, [&](const CellAnalysis& cell) {
    const NeesResult* nees = cell.find_nees(block, cell.leading);
    if (nees == nullptr) return std::vector<double>{};
    dimension = nees->series.dimension;
    return nees->series.average;
  });
  if (!panel.curves.empty()) panel.bands = bands(study, dimension);
  return panel;
}

Figure anees_figure(const StudyAnalysis& study) {
  Figure figure{"anees", "Is the filter right about its own errors?", ""};
  figure.sentence =
      "Average normalised error squared (ANEES) of the pose over time. The grey band is where "
      "chance leaves a filter whose stated uncertainty fits its real errors; a curve that climbs "
      "above the band and stays there belongs to a filter that is sure of a wrong answer. The axis "
      "ends at 1000 times the band; the numbers hold every value, also of curves beyond the top.";
  add_panels({anees_panel(study, ErrorBlock::pose, "anees_pose", "ANEES of the pose")}, study.times,
             figure);
  return figure;
}

Figure anees_parts_figure(const StudyAnalysis& study) {
  Figure figure{"anees_parts", "Position or heading: which one goes wrong?", ""};
  figure.sentence =
      "The same test for position alone (two components, right around 2) and heading alone (one "
      "component, right around 1): the curve that leaves its band first shows where trouble "
      "begins.";
  add_panels({anees_panel(study, ErrorBlock::position, "anees_position", "ANEES of position"),
              anees_panel(study, ErrorBlock::heading, "anees_heading", "ANEES of heading")},
             study.times, figure);
  return figure;
}

Section verdict_section(const StudyAnalysis& study) {
  Section section{"verdict", "Verdict"};
  section.add("verdict", verdict_table(study));
  const bool has_poses = !study.imported.is_imported() || study.imported.state == "pose";
  if (has_poses) section.add("accuracy", accuracy_table(study));
  section.add(imported_notes(study));
  section.add(too_few_notes(study));
  section.add(verdict_notes(study));
  section.add(bound_notes(study.bound));
  return section;
}

Section consistency_section(const StudyAnalysis& study) {
  Section section{"consistency", "The whole test"};
  section.is_for_terminal = false;
  section.add("consistency", consistency_table(study));
  section.add(consistency_notes());
  return section;
}

std::vector<Section> nees_sections(const StudyAnalysis& study) {
  if (!study.has_truth) return {};
  return {verdict_section(study), consistency_section(study)};
}

std::vector<Figure> nees_figures(const StudyAnalysis& study) {
  return {anees_figure(study), anees_parts_figure(study)};
}

}  // namespace

Metric nees_metric() {
  return {.scores = kNeesScores,
          .scores_are_numbers = false,
          .sums = make_sums<NeesOverRuns>,
          .add_series = nees_series,
          .sections = nees_sections,
          .figures = nees_figures};
}

}  // namespace montecarta::analysis
