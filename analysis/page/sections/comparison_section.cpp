// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/comparison_tables.hpp"
#include "analysis/page/sections.hpp"

namespace montecarta::analysis {

Section comparison_section(const StudyAnalysis& study, const StudyComparison& comparison) {
  const Comparisons& all = comparison.comparisons;
  if (!study.has_truth || all.rows.empty()) return {};
  Section section{"comparison", "Compared with " + all.baseline};
  section.is_for_terminal = false;
  section.add("comparison", comparison_table(all));
  section.add(comparison_notes(study, all));
  for (const WinMatrix& matrix : comparison.matrices) {
    section.add("wins_" + std::string(matrix.score->name), win_table(matrix, all.level));
  }
  section.add(std::vector{win_note(all.level)});
  section.add("pareto", pareto_table(comparison.values));
  section.add(std::vector{pareto_note()});
  return section;
}

}  // namespace montecarta::analysis
