// SPDX-License-Identifier: BSD-3-Clause
// Proper scoring rules, which rank distributions: log score and energy score (STATISTICS 7).
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"

#include <vector>

namespace montecarta::analysis {
namespace {

constexpr Score kProperScores[] = {
    {"log_score", "1", "log score of the pose",
     [](const MeasuredRun& run) { return run.proper.log_score; }, Better::lower, false},
    {"energy_score", "m", "energy score of the position",
     [](const MeasuredRun& run) { return run.proper.energy_score; }},
};

std::vector<TextTable::Entry> proper_scores_row(const CellAnalysis& cell) {
  const Spread log_scores = cell.known_over_runs("log_score");
  if (log_scores.summary.n == 0) return {};
  return {{"log score", readable(log_scores.summary.mean)},
          {"energy score [m]", readable(cell.known_over_runs("energy_score").summary.mean)}};
}

std::vector<Section> proper_scores_sections(const StudyAnalysis& study) {
  const CellNumber log_score = [](const CellAnalysis& cell) {
    return cell.known_over_runs("log_score").summary.mean;
  };
  return table_section(
      section_of("proper_scores", {{"scores", range_over_cells(study, log_score)}}),
      cell_table(study, proper_scores_row));
}

}  // namespace

Metric proper_scores_metric() {
  return {.scores = kProperScores, .sections = proper_scores_sections};
}

}  // namespace montecarta::analysis
