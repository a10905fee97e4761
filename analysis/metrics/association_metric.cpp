// SPDX-License-Identifier: BSD-3-Clause
// Associations of detections, summed over the scans of a run (AssociationCounts).
#include "analysis/metrics/cell_range.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"

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

std::vector<TextTable::Entry> association_row(const CellAnalysis& cell) {
  const auto mean = [&](std::string_view score) { return cell.over_runs(score).mean; };
  const double correct = mean("association_correct"), wrong = mean("association_wrong"),
               new_again = mean("association_new_again"), missed = mean("association_missed"),
               all = correct + wrong + new_again + missed;
  return {{"cell", cell.label, Align::left},
          {"detections", readable(all, 4)},
          {"correct", percent(correct / all)},
          {"wrong", percent(wrong / all)},
          {"new again", percent(new_again / all)},
          {"left out", percent(missed / all)},
          {"false accepted", readable(mean("association_clutter"))}};
}

/// Share of the detections that went to a wrong landmark.
double wrong_share(const CellAnalysis& cell) {
  double all = 0.0;
  for (const char* one : {"association_correct", "association_wrong", "association_new_again",
                          "association_missed"}) {
    all += cell.over_runs(one).mean;
  }
  return cell.over_runs("association_wrong").mean / all;
}

TextTable association_table(const StudyAnalysis& study) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) {
    if (!std::isnan(cell.over_runs("association_correct").mean)) table.add(association_row(cell));
  }
  return table;
}

std::vector<Section> association_sections(const StudyAnalysis& study) {
  const TextTable table = association_table(study);
  if (table.rows.empty()) return {};
  Section section =
      section_of("association", {{"wrong", range_over_cells(study, wrong_share, percent)}});
  section.add("association", table);
  section.add_notes("notes");
  return {section};
}

}  // namespace

Metric association_metric() {
  return {.scores = kAssociationScores, .sections = association_sections};
}

}  // namespace montecarta::analysis
