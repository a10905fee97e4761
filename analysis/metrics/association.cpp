// SPDX-License-Identifier: BSD-3-Clause
// Counts of the associations of detections (AssociationCounts), summed over the scans of a run.
#include "analysis/run/measured_run.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/cell_report.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

template <std::vector<double> AssociationRows::*kCounts>
double sum_of_counts(const MeasuredRun& run) {
  return sum_of(run.rows.association.*kCounts);
}

constexpr Score kAssociationScores[] = {
    {"association_correct", "1", "detections rightly associated",
     sum_of_counts<&AssociationRows::correct>, Better::higher},
    {"association_wrong", "1", "detections given to a wrong landmark",
     sum_of_counts<&AssociationRows::wrong>},
    {"association_new_again", "1", "detections made new again",
     sum_of_counts<&AssociationRows::new_again>},
    {"association_missed", "1", "detections left out", sum_of_counts<&AssociationRows::missed>},
    {"association_clutter", "1", "false alarms accepted", sum_of_counts<&AssociationRows::clutter>},
};

/// Mean over runs of the number of detections of known landmarks; NaN if they were not counted.
double detections_of(const CellAnalysis& cell) {
  double all = 0.0;
  for (const char* one : {"association_correct", "association_wrong", "association_new_again",
                          "association_missed"}) {
    all += cell.over_runs(one).mean;
  }
  return all;
}

double wrong_share(const CellAnalysis& cell) {
  return cell.over_runs("association_wrong").mean / detections_of(cell);
}

std::vector<TextTable::Entry> association_row(const CellAnalysis& cell, double level) {
  const double all = detections_of(cell);
  if (std::isnan(all)) return {};
  std::vector<double> wrong = cell.scores.column("association_wrong");
  std::ranges::sort(wrong);
  const auto share = [&](const char* score) { return percent(cell.over_runs(score).mean / all); };
  return {{"detections", readable(all, 4)},
          {"correct", share("association_correct")},
          {"wrong", share("association_wrong")},
          {"new again", share("association_new_again")},
          {"left out", share("association_missed")},
          {"false accepted", readable(cell.over_runs("association_clutter").mean)},
          {"wrong in the middle run [" + level_text(level) + "]",
           with_interval(median_of(wrong), median_interval(wrong, level))}};
}

std::vector<Section> association_sections(const StudyAnalysis& study) {
  return table_section(
      section_of("association", {{"wrong", range_over_cells(study, wrong_share, percent)}}),
      cell_table(study,
                 [&](const CellAnalysis& cell) { return association_row(cell, study.level); }));
}

}  // namespace

Metric association_metric() {
  return {.scores = kAssociationScores, .sections = association_sections};
}

}  // namespace montecarta::analysis
