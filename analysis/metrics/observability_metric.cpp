// SPDX-License-Identifier: BSD-3-Clause
// Information about the heading of the whole, which no detection can give (STATISTICS 22).
#include "analysis/metrics/cell_panels.hpp"
#include "analysis/metrics/cell_range.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/numbers/angle.hpp"

#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr Score kObservabilityScores[] = {
    {"rotation_information", "rad-2", "information about the heading of the whole at the end",
     [](const MeasuredRun& run) {
       const auto& information = run.rows.rotation_information;
       return information.empty() ? kNaN : information.back();
     }},
};

constexpr ScanSeries kObservabilitySeries[] = {
    {"rotation_information", "rad-2",
     [](const MeasuredRun& run) { return run.rows.rotation_information; }},
};

/// Standard deviation [deg]; beyond a full turn it has no meaning.
std::string heading_of(double information) {
  const double degrees = 180.0 / kPi / std::sqrt(information);
  return degrees > 360.0 ? "nothing" : readable(degrees);
}

TextTable observability_table(const StudyAnalysis& study) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) {
    const double information = cell.over_runs("rotation_information").mean;
    if (std::isnan(information)) continue;
    table.add({{"cell", cell.label, Align::left},
               {"information [1/rad^2]", readable(information)},
               {"equivalent heading sigma [deg]", heading_of(information)}});
  }
  return table;
}

std::vector<Section> observability_sections(const StudyAnalysis& study) {
  const TextTable table = observability_table(study);
  if (table.rows.empty()) return {};
  const CellNumber information = [](const CellAnalysis& cell) {
    return cell.over_runs("rotation_information").mean;
  };
  Section section =
      section_of("observability", {{"information", range_over_cells(study, information)}});
  section.add("observability", table);
  section.add_notes("notes");
  return {section};
}

std::vector<Figure> observability_figures(const StudyAnalysis& study) {
  Figure figure = figure_of("observability");
  const CellValues values = [](const CellAnalysis& cell) {
    return cell.over_time("rotation_information");
  };
  add_panels({{"rotation_information",
               "information [1/rad^2]",
               cell_curves(study, values),
               {},
               Scale::from_zero}},
             study.times, figure);
  return {figure};
}

}  // namespace

Metric observability_metric() {
  return {.scores = kObservabilityScores,
          .scan_series = kObservabilitySeries,
          .sections = observability_sections,
          .figures = observability_figures};
}

}  // namespace montecarta::analysis
