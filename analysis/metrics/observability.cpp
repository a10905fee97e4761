// SPDX-License-Identifier: BSD-3-Clause
// Information that the filter has about the heading of path and map together, although no detection
// can give any (STATISTICS 22).
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"

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

/// Text of the standard deviation [deg] of the heading, which has no meaning beyond a full turn.
std::string heading_of(double information) {
  const double degrees = 180.0 / kPi / std::sqrt(information);
  return degrees > 360.0 ? "nothing" : readable(degrees);
}

double information_of(const CellAnalysis& cell) {
  return cell.over_runs("rotation_information").mean;
}

std::vector<TextTable::Entry> observability_row(const CellAnalysis& cell) {
  const double information = information_of(cell);
  if (std::isnan(information)) return {};
  return {{"information [1/rad^2]", readable(information)},
          {"equivalent heading sigma [deg]", heading_of(information)}};
}

std::vector<Section> observability_sections(const StudyAnalysis& study) {
  return table_section(
      section_of("observability", {{"information", range_over_cells(study, information_of)}}),
      cell_table(study, observability_row));
}

std::vector<Figure> observability_figures(const StudyAnalysis& study) {
  return {cell_figure(
      study, figure_of("observability"), {"rotation_information", "information [1/rad^2]", {}, {}},
      [](const CellAnalysis& cell) { return cell.over_time("rotation_information"); })};
}

}  // namespace

Metric observability_metric() {
  return {.scores = kObservabilityScores,
          .scan_series = kObservabilitySeries,
          .sections = observability_sections,
          .figures = observability_figures};
}

}  // namespace montecarta::analysis
