// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"
#include "analysis/tables/map_error_table.hpp"

namespace montecarta {

Section verdict_section(const StudyAnalysis& study) {
  if (!study.has_truth) return {};
  Section section{"Verdict"};
  add_table("verdict", verdict_table(study), section);
  add_table("accuracy", accuracy_table(study), section);
  add_notes(verdict_notes(study), section);
  add_notes(bound_notes(study), section);
  return section;
}

}  // namespace montecarta
