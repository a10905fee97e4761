// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/html.hpp"
#include "analysis/page/sections.hpp"
#include "analysis/tables/reference_table.hpp"

namespace montecarta {

Section reference_section(const StudyAnalysis& study) {
  if (study.has_truth && study.references.empty()) return {};
  Section section{"Judged by references"};
  if (!study.has_truth) section.body += "<p>" + html_escape(no_truth_sentence()) + "</p>\n";
  add_table("reference", reference_table(study), section);
  add_table("baseline", baseline_table(study), section);
  add_table("map", map_table(study), section);
  add_notes(reference_notes(study), section);
  return section;
}

}  // namespace montecarta
