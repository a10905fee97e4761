// SPDX-License-Identifier: BSD-3-Clause
// What differential evolution changed at the scans at which something evolved (STATISTICS 24).
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/verdict_table.hpp"

#include <cmath>
#include <iterator>

namespace montecarta::analysis {
namespace {

using EvolutionColumn = std::vector<double> EvolutionRows::*;

/// Mean of a column over the scans at which something evolved; NaN if there are none.
template <EvolutionColumn kColumn>
double mean_of_evolution(const MeasuredRun& run) {
  const EvolutionRows& rows = run.rows.evolution;
  double sum = 0.0, scans = 0.0;
  for (std::size_t s = 0; s < rows.evaluations.size(); ++s) {
    if (rows.evaluations[s] == 0.0) continue;
    sum += (rows.*kColumn)[s];
    scans += 1.0;
  }
  return sum / scans;
}

template <EvolutionColumn kColumn>
std::vector<double> evolution_at_scans(const MeasuredRun& run) {
  return run.rows.evolution.*kColumn;
}

constexpr Score kEvolutionScores[] = {
    {"evolution_evaluations", "1", "evaluations of the fitness per scan",
     mean_of_evolution<&EvolutionRows::evaluations>, Better::neither},
    {"evolution_generations", "1", "generations of the evolution per scan",
     mean_of_evolution<&EvolutionRows::generations>, Better::neither},
    {"evolution_gain", "1", "gain of log fitness by evolution per scan",
     mean_of_evolution<&EvolutionRows::gain>, Better::neither},
    {"evolution_displacement", "1", "displacement by evolution per scan",
     mean_of_evolution<&EvolutionRows::displacement>, Better::neither},
};

constexpr ScanSeries kEvolutionSeries[] = {
    {"evolution_evaluations", "1", evolution_at_scans<&EvolutionRows::evaluations>},
    {"evolution_generations", "1", evolution_at_scans<&EvolutionRows::generations>},
    {"evolution_gain", "1", evolution_at_scans<&EvolutionRows::gain>},
    {"evolution_displacement", "1", evolution_at_scans<&EvolutionRows::displacement>},
};

double gain_of(const CellAnalysis& cell) { return cell.over_runs("evolution_gain").mean; }

/// The row of a cell; `level` is that of the intervals.
std::vector<TextTable::Entry> evolution_row(const CellAnalysis& cell, double level) {
  if (std::isnan(gain_of(cell))) return {};
  const std::string with_level = " [" + level_text(level) + "]";
  const auto mean = [&](const char* score) { return readable(cell.over_runs(score).mean); };
  return {{"evaluations", mean("evolution_evaluations")},
          {"generations", mean("evolution_generations")},
          {"gain [nat]" + with_level, score_text(cell, "evolution_gain", level).text()},
          {"displacement [sigma]" + with_level,
           score_text(cell, "evolution_displacement", level).text()}};
}

std::vector<Section> evolution_sections(const StudyAnalysis& study) {
  return table_section(section_of("evolution", {{"gain", range_over_cells(study, gain_of)}}),
                       cell_table(study, [&](const CellAnalysis& cell) {
                         return evolution_row(cell, study.level);
                       }));
}

std::vector<Figure> evolution_figures(const StudyAnalysis& study) {
  Figure figure = figure_of("evolution");
  constexpr double kNothing = 1e-4;  // less than this changes nothing, in nat or deviations
  const auto panels_of = [&](const char* series, const char* label) {
    return cell_panels(study, {series, label, {}, {}, Scale::automatic, kNothing},
                       [&](const CellAnalysis& cell) { return cell.over_time(series); });
  };
  std::vector<Panel> panels = panels_of("evolution_gain", "gain [nat]");
  std::ranges::move(panels_of("evolution_displacement", "displacement [sigma]"),
                    std::back_inserter(panels));
  add_panels(panels, study.times, figure);
  return {figure};
}

}  // namespace

Metric evolution_metric() {
  return {.scores = kEvolutionScores,
          .scan_series = kEvolutionSeries,
          .sections = evolution_sections,
          .figures = evolution_figures};
}

}  // namespace montecarta::analysis
