// SPDX-License-Identifier: BSD-3-Clause
// Number of effective particles, and number of ancestors that still have descendants.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/lineage_sums.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

using Counts = std::vector<std::uint32_t>;

template <Counts Diversity::*kCounts>
std::vector<double> counts_over_time(const MeasuredRun& run) {
  const Diversity* diversity = run.metrics.diversity();
  if (diversity == nullptr) return {};
  return {(diversity->*kCounts).begin(), (diversity->*kCounts).end()};
}

template <Counts Diversity::*kCounts>
double mean_of_counts(const MeasuredRun& run) {
  return mean_of(counts_over_time<kCounts>(run));
}

double first_with_descendants(const MeasuredRun& run) {
  const Diversity* diversity = run.metrics.diversity();
  return diversity == nullptr ? kNaN : diversity->root.back();
}

constexpr Score kParticlesScores[] = {
    {"ess", "1", "effective particles",
     [](const MeasuredRun& run) { return mean_of(run.rows.ess); }, Better::higher},
    {"resampling_rate", "1", "share of scans that resample",
     [](const MeasuredRun& run) { return mean_of(run.rows.resampled); }, Better::neither},
    {"ancestors_last_resampling", "1", "distinct particles after a resampling",
     mean_of_counts<&Diversity::last_resampling>, Better::higher},
    {"ancestors_10_s_ago", "1", "distinct ancestors 10 s ago", mean_of_counts<&Diversity::lag>,
     Better::higher},
    {"ancestors_at_start", "1", "distinct ancestors at the start", mean_of_counts<&Diversity::root>,
     Better::higher},
    {"ancestors_at_start_at_the_end", "1", "first particles that have descendants at the end",
     first_with_descendants, Better::higher},
};

constexpr ScanSeries kParticlesSeries[] = {
    {"ess", "1", [](const MeasuredRun& run) { return run.rows.ess; }},
    {"ancestors_last_resampling", "1", counts_over_time<&Diversity::last_resampling>},
    {"ancestors_10_s_ago", "1", counts_over_time<&Diversity::lag>},
    {"ancestors_at_start", "1", counts_over_time<&Diversity::root>},
};

std::vector<TextTable::Entry> diversity_row(const StudyAnalysis& study, const CellAnalysis& cell) {
  const bool has_ess = study.own_drives > 0 ? cell.complete > 0 : !cell.over_time("ess").empty();
  if (!has_ess) return {};
  std::vector<TextTable::Entry> row = {
      {"ESS", readable(cell.over_runs("ess").mean)},
      {"resampled", percent(cell.over_runs("resampling_rate").mean)}};
  LineageSummary none;
  none.ancestors.fill(kNaN);
  const LineageSummary* found = cell.find<LineageSummary>();
  add_entries(lineage_numbers(), found != nullptr ? *found : none, study.level, row);
  return row;
}

/// Makes a panel of the number of distinct ancestors.
Panel ancestor_panel(const StudyAnalysis& study, const std::string& series,
                     const std::string& label) {
  const CellValues values = [&](const CellAnalysis& cell) { return cell.over_time(series); };
  return {series, label, cell_curves(study, values), {}, Scale::logarithmic};
}

Figure diversity_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("diversity");
  add_panels({ancestor_panel(study, "ancestors_last_resampling", "parents, last resampling"),
              ancestor_panel(study, "ancestors_10_s_ago", "ancestors, 10 s ago"),
              ancestor_panel(study, "ancestors_at_start", "ancestors at the start")},
             study.times, figure);
  return figure;
}

Figure ess_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("ess");
  const CellValues share = [](const CellAnalysis& cell) {
    return scaled(cell.over_time("ess"), 100.0 / static_cast<double>(cell.particles));
  };
  add_panels(
      {{"ess_share", "effective particles [%]", cell_curves(study, share), {}, Scale::percent}},
      study.times, figure);
  return figure;
}

/// Text of the age of the common ancestor or, without ancestry, of the number of effective
/// particles.
std::string diversity_summary(const StudyAnalysis& study) {
  const CellNumber back = [](const CellAnalysis& cell) {
    return cell.get<LineageSummary>().coalescence;
  };
  const std::string range = range_over_cells(study, back, fixed_seconds);
  if (range != "-") return "the common ancestor of all particles lies " + range + " back";
  const CellNumber ess = [](const CellAnalysis& cell) { return cell.over_runs("ess").mean; };
  return "effective particles (ESS) " + range_over_cells(study, ess);
}

std::vector<Section> particles_sections(const StudyAnalysis& study) {
  Section section = section_of("diversity");
  const TextTable table =
      cell_table(study, [&](const CellAnalysis& cell) { return diversity_row(study, cell); });
  section.add("diversity", table);
  section.summary = diversity_summary(study);
  if (!table.rows.empty()) section.add_notes("notes");
  return {section};
}

std::vector<Figure> particles_figures(const StudyAnalysis& study) {
  return {diversity_figure(study), ess_figure(study)};
}

}  // namespace

Metric particles_metric() { return {.scores = kParticlesScores}; }

/// Diversity is a metric apart from the scores of the particles because its series come last in
/// files.
Metric diversity_metric() {
  return {.scan_series = kParticlesSeries,
          .sections = particles_sections,
          .figures = particles_figures};
}

}  // namespace montecarta::analysis
