// SPDX-License-Identifier: BSD-3-Clause
// Efficiency of each cell against the study's cell of full smoothing.
#include "analysis/study/cell_report.hpp"
#include "analysis/study/paired_runs.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Returns the cell of full smoothing; nullptr if the study has none, or has no other cell.
const CellAnalysis* smoother_of(const StudyAnalysis& study) {
  const auto smooths = [](const CellAnalysis& cell) {
    return cell.filter == "smoother" && cell.complete > 0;
  };
  const auto found = std::ranges::find_if(study.cells, smooths);
  return found == study.cells.end() || study.cells.size() < 2 ? nullptr : &*found;
}

/// Returns pairs of runs with the smoother's mean squares on the left and the cell's on the right.
PairedRuns runs_beside(const CellAnalysis& cell, const CellAnalysis& smoother,
                       const char* mean_square) {
  return paired_runs(smoother, cell, *find_score(mean_square));
}

/// Root of the ratio of two mean squares, the smoother's divided by the cell's; NaN if one of them
/// is not above 0.
double paired_efficiency(const PairedRuns& runs) {
  const double above = mean_of(runs.left), below = mean_of(runs.right);
  return below > 0.0 && above > 0.0 ? std::sqrt(above / below) : kNaN;
}

/// Text of the efficiency over the runs that both completed, with its interval (STATISTICS 21).
std::string efficiency_text(const CellAnalysis& cell, const CellAnalysis& smoother,
                            const char* mean_square, double level) {
  const PairedRuns runs = runs_beside(cell, smoother, mean_square);
  const double efficiency = paired_efficiency(runs);
  if (std::isnan(efficiency)) return "-";
  const double above = mean_of(runs.left), below = mean_of(runs.right);
  if (runs.left.size() < 2) return readable(efficiency);
  SummaryOf differences;  // terms of half the logarithm of the ratio, to first order
  for (std::size_t k = 0; k < runs.left.size(); ++k) {
    differences.add(0.5 * (runs.left[k] / above - runs.right[k] / below));
  }
  const double half_width = differences.result().half_width(level);
  if (!(half_width > 0.0)) return readable(efficiency);  // the ratio is the same in every run
  return with_interval(efficiency,
                       {efficiency * std::exp(-half_width), efficiency * std::exp(half_width)});
}

std::vector<TextTable::Entry> row_beside(const CellAnalysis& cell, const CellAnalysis& smoother,
                                         double level) {
  const auto cpu = [](const CellAnalysis& of) { return of.over_runs("cpu_seconds").mean; };
  const auto is_judged = [](const CellAnalysis& of) {
    return of.verdict.answer != Answer::untested;
  };
  const bool are_judged = is_judged(cell) && is_judged(smoother);
  const double ratio = cell.verdict.ratio_estimate() / smoother.verdict.ratio_estimate();
  return {{"position efficiency", efficiency_text(cell, smoother, "position_mse", level)},
          {"heading efficiency", efficiency_text(cell, smoother, "heading_mse", level)},
          {"ANEES / smoother's", are_judged ? compact(ratio) : "-"},
          {"CPU / smoother's", readable(cpu(cell) / cpu(smoother))}};
}

std::vector<Section> smoother_sections(const StudyAnalysis& study) {
  const CellAnalysis* smoother = smoother_of(study);
  if (smoother == nullptr || !study.has_truth) return {};
  const CellEntries row = [&](const CellAnalysis& cell) {
    return &cell == smoother ? std::vector<TextTable::Entry>{}
                             : row_beside(cell, *smoother, study.level);
  };
  const CellNumber efficiency = [&](const CellAnalysis& cell) {
    return &cell == smoother ? kNaN
                             : paired_efficiency(runs_beside(cell, *smoother, "position_mse"));
  };
  return table_section(
      section_of("smoother", {{"smoother", smoother->label},
                              {"efficiency", range_over_cells(study, efficiency)}}),
      cell_table(study, row), {{"smoother", smoother->label}});
}

}  // namespace

Metric smoother_metric() { return {.sections = smoother_sections}; }

}  // namespace montecarta::analysis
