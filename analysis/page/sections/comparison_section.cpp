// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/comparison/comparison_tables.hpp"
#include "analysis/figures/pareto_figure.hpp"
#include "analysis/page/sections.hpp"

namespace montecarta {

Section comparison_section(const StudyAnalysis& study, const StudyComparison& comparison) {
  const Comparisons& all = comparison.comparisons;
  if (!study.has_truth || all.rows.empty()) return {};
  Section section{"Compared with " + all.baseline};
  add_table("comparison", comparison_table(all), section);
  add_notes(comparison_notes(study, all), section);
  for (const WinMatrix& matrix : comparison.matrices) {
    add_table("wins_" + std::string(matrix.score->name), win_table(matrix, all.level), section);
  }
  add_notes({win_note(all.level)}, section);
  add_table("pareto", pareto_table(comparison.values), section);
  add_notes({pareto_note()}, section);
  section.figures = figure_section({pareto_figure(comparison.values)}).figures;
  return section;
}

}  // namespace montecarta
