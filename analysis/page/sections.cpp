// SPDX-License-Identifier: BSD-3-Clause
// The short ones; the player is in replay/replay_section.cpp.
#include "analysis/comparison/comparison_tables.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/page/html.hpp"
#include "analysis/page/page.hpp"

namespace montecarta::analysis {
namespace {

std::string details(const std::string& summary, const std::string& content) {
  return "<details><summary>" + summary + "</summary>" + content + "</details>\n";
}

}  // namespace

Section title_section(const StudyAnalysis& study) {
  Section section{"title", ""};
  section.add_html("<h1>" + html_escape(study.title.empty() ? study.study_name : study.title) +
                   "</h1>\n<p class=\"soft\">" + html_escape(study.study_name) + " &middot; " +
                   std::to_string(study.runs_here) + " of " + std::to_string(study.study_runs) +
                   " runs &middot; " + study.scans_text() + " &middot; seed " +
                   std::to_string(study.seed) + " &middot; " + html_escape(study.file) + "</p>\n");
  return section;
}

Section failure_section(const StudyAnalysis& study) {
  if (!study.has_failures()) return {};
  Section section{"failures", "Failed runs"};
  section.add("failures", failure_table(study));
  section.add(std::vector<std::string>{
      "These runs ended early and are left out of everything else; the step counts from 0. "
      "If they failed because the filter diverged, what is left looks better than the "
      "filter is."});
  return section;
}

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

Section origin_section(const ResultFile& file, const StudyAnalysis& study) {
  Section section{"origin", "Where this comes from"};
  section.add(std::vector{"Same study, same build, same numbers: study " + study.study_sha256 +
                          ". Tables are in tables/ as CSV and LaTeX."});
  section.add_html(details("Scenario", html_pairs(file.scenario())) +
                   details("Provenance", html_pairs(file.provenance())) +
                   details("Study file, with everything filled in",
                           "<pre>" + html_escape(file.study_text()) + "</pre>"));
  return section;
}

}  // namespace montecarta::analysis
