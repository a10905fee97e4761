// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/html.hpp"
#include "analysis/page/sections.hpp"

namespace montecarta::analysis {

Section title_section(const StudyAnalysis& study) {
  Section section{"title", ""};
  section.add_html("<h1>" + html_escape(study.title.empty() ? study.study_name : study.title) +
                   "</h1>\n<p class=\"soft\">" + html_escape(study.study_name) + " &middot; " +
                   std::to_string(study.runs_here) + " of " + std::to_string(study.study_runs) +
                   " runs &middot; " + std::to_string(study.times.size()) +
                   " scans each &middot; seed " + std::to_string(study.seed) + " &middot; " +
                   html_escape(study.file) + "</p>\n");
  return section;
}

}  // namespace montecarta::analysis
