// SPDX-License-Identifier: BSD-3-Clause
// NEES of the pose and its parts, over time and over runs.
#include "analysis/run/imported_state.hpp"
#include "analysis/run/measured_run.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/nees_accumulator.hpp"
#include "analysis/study/strips.hpp"
#include "analysis/study/verdict_table.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Mean NEES over the scans of a run, by its leading moments.
double mean_nees(const MeasuredRun& run, ErrorBlock block) {
  const NeesRows* nees = run.metrics.leading_nees();
  return nees == nullptr ? kNaN : mean_of_finite(nees->value[static_cast<std::size_t>(block)]);
}

constexpr Score kNeesScores[] = {
    {"nees", "1", "mean NEES of the pose",
     [](const MeasuredRun& run) { return mean_nees(run, ErrorBlock::pose); }, Better::neither},
    {"nees_position", "1", "mean NEES of the position",
     [](const MeasuredRun& run) { return mean_nees(run, ErrorBlock::position); }, Better::neither},
    {"nees_heading", "1", "mean NEES of the heading",
     [](const MeasuredRun& run) { return mean_nees(run, ErrorBlock::heading); }, Better::neither},
};

class NeesOverRuns final : public MergedSums<NeesOverRuns> {
 public:
  explicit NeesOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    if (nees_.empty()) begin(run.metrics);
    for (NeesAccumulator& nees : nees_) nees.add(run.metrics);
  }
  void put(CellAnalysis& cell) override {
    if (!nees_.empty()) cell.leading = nees_.front().moments();
    for (const NeesAccumulator& nees : nees_) {
      cell.nees.push_back(nees.result(criteria_->level));
    }
  }
  static constexpr auto parts() { return std::tuple(added(&NeesOverRuns::nees_)); }

 private:
  /// Makes the sums at the first run: all runs of a cell have the same moments.
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
  std::vector<NeesAccumulator> nees_;  ///< leading moments first
};

void add_nees(const NeesResult& nees, std::vector<Frame::Column>& all) {
  const NeesSeries& series = nees.series;
  const std::string suffix = "_" + name_of(nees.block) + "_" + name_of(nees.moments);
  all.push_back({"anees" + suffix, "1", series.average});
  all.push_back({"lower" + suffix, "1", ends_of(series.bounds, &Interval::lower)});
  all.push_back({"upper" + suffix, "1", ends_of(series.bounds, &Interval::upper)});
  all.push_back({"runs" + suffix, "1", {series.runs.begin(), series.runs.end()}});
}

void nees_series(const CellAnalysis& cell, std::vector<Frame::Column>& all) {
  for (const NeesResult& nees : cell.nees) add_nees(nees, all);
}

/// Returns one band for every number of complete runs that a tested cell has, since the bounds
/// depend on it.
std::vector<Band> bands(const StudyAnalysis& study, std::size_t dimension) {
  std::set<std::size_t> runs;
  for (const CellAnalysis& cell : study.cells) {
    if (!cell.nees.empty()) runs.insert(cell.complete);
  }
  const auto d = static_cast<double>(dimension);
  std::vector<Band> found;
  for (const std::size_t n : runs) {
    const Interval band = nees_bounds(n, dimension, study.level);
    found.push_back(
        {found.empty() ? level_text(study.level) + " band" : "", band.lower / d, band.upper / d});
  }
  return found;
}

/// Label of a panel: "NEES ratio of the pose".
std::string label_of(const StudyAnalysis& study, ErrorBlock block) {
  return std::string(study.imported.name_of_ratio()) + " of the " +
         (block == ErrorBlock::pose ? study.imported.name_of_whole() : name_of(block));
}

/// Whether the ratios of a cell are only bounds.
bool has_bounded_cells(const StudyAnalysis& study) {
  return std::ranges::any_of(study.cells,
                             [](const CellAnalysis& cell) { return has_bounds(cell.settings); });
}

Panel nees_panel(const StudyAnalysis& study, ErrorBlock block) {
  Panel panel{"nees_ratio_" + name_of(block), label_of(study, block), {}, {}, Scale::automatic};
  std::size_t dimension = 0;
  panel.curves = cell_curves(study, [&](const CellAnalysis& cell) {
    const NeesResult* nees = cell.find_nees(block, cell.leading);
    if (nees == nullptr) return std::vector<double>{};
    dimension = nees->series.dimension;
    return scaled(nees->series.average, 1.0 / static_cast<double>(dimension));
  });
  const bool is_bound = has_bounded_cells(study);  // of which no law is known
  if (!panel.curves.empty() && !is_bound) panel.bands = bands(study, dimension);
  return panel;
}

/// Makes a row of strips with the NEES ratio of a cell over time.
StripRow strip_of(const CellAnalysis& cell, const NeesResult& nees) {
  const auto dimension = static_cast<double>(nees.series.dimension);
  StripRow row{
      cell.label, scaled(nees.series.average, 1.0 / dimension), {}, compact(nees.mean / dimension)};
  for (const Interval& band : nees.series.bounds)
    row.band.push_back({band.lower / dimension, band.upper / dimension});
  return row;
}

StripPanel nees_strips(const StudyAnalysis& study, ErrorBlock block) {
  StripPanel panel{"nees_ratio_" + name_of(block),
                   label_of(study, block),
                   "inside the " + level_text(study.level) + " band",
                   "mean",
                   {}};
  for (const CellAnalysis& cell : study.cells) {
    const NeesResult* nees = cell.find_nees(block, cell.leading);
    if (nees != nullptr) panel.rows.push_back(strip_of(cell, *nees));
  }
  return panel;
}

/// Makes a figure of the NEES ratio: strips for more than kMostRatioCurves cells, else curves.
Figure nees_figure(const StudyAnalysis& study, const std::vector<ErrorBlock>& blocks,
                   const std::string& of_strips, const std::string& of_curves, Figure figure) {
  std::vector<StripPanel> strips;
  std::vector<Panel> panels;
  for (const ErrorBlock block : blocks) {
    strips.push_back(nees_strips(study, block));
    panels.push_back(nees_panel(study, block));
  }
  if (strips.front().rows.size() > kMostRatioCurves) {
    figure.sentence =
        of_strips + " " + prose("consistency", "strips", {{"level", level_text(study.level)}});
    add_strips(strips, study.times, figure);
  } else {
    figure.sentence = of_curves;
    add_panels(panels, study.times, figure);
  }
  return figure;
}

Figure anees_figure(const StudyAnalysis& study) {
  const Values whole = {{"whole", study.imported.name_of_whole()}};
  Values curve = whole;
  const bool is_of_innovations = study.imported.are_innovations();
  curve.emplace_back("nees", is_of_innovations ? "NIS" : "NEES");
  curve.emplace_back("level", level_text(study.level));
  const bool is_bound = has_bounded_cells(study);
  return nees_figure(study, {ErrorBlock::pose}, prose("consistency", "strips of whole", whole),
                     is_bound ? prose("consistency", "curves of bound", whole)
                              : prose("consistency", "curves of whole", curve),
                     figure_of("anees"));
}

Figure anees_parts_figure(const StudyAnalysis& study) {
  return nees_figure(study, {ErrorBlock::position, ErrorBlock::heading},
                     prose("consistency", "strips of parts"),
                     prose("consistency", "curves of parts"), figure_of("anees_parts"));
}

Section consistency_section(const StudyAnalysis& study) {
  const CellNumber inside = [](const CellAnalysis& cell) {
    const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
    return pose == nullptr || !pose->is_tested() ? kNaN : pose->share_inside();
  };
  Section section = section_of(
      "consistency",
      {{"level", level_text(study.level)}, {"inside", range_over_cells(study, inside, percent)}});
  section.is_for_terminal = false;
  const TextTable table = consistency_table(study);
  section.add("consistency", table);
  if (!table.rows.empty()) section.add_notes("notes");
  return section;
}

std::vector<Section> nees_sections(const StudyAnalysis& study) {
  if (!study.has_truth) return {};
  return {consistency_section(study)};
}

std::vector<Figure> nees_figures(const StudyAnalysis& study) {
  return {anees_figure(study), anees_parts_figure(study)};
}

}  // namespace

Metric consistency_metric() {
  return {.scores = kNeesScores,
          .scores_are_numbers = false,
          .sums = make_sums<NeesOverRuns>,
          .add_series = nees_series,
          .sections = nees_sections,
          .figures = nees_figures};
}

}  // namespace montecarta::analysis
