// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/html.hpp"
#include "analysis/page/sections.hpp"

namespace montecarta::analysis {
namespace {

std::string details(const std::string& summary, const std::string& content) {
  return "<details><summary>" + summary + "</summary>" + content + "</details>\n";
}

}  // namespace

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
