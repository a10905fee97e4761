// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"
#include "analysis/tables/why_tables.hpp"

namespace montecarta {

Section diversity_section(const StudyAnalysis& study) {
  const TextTable table = diversity_table(study);
  if (table.rows.empty()) return {};
  Section section{"How many histories survive?"};
  add_table("diversity", table, section);
  add_notes(diversity_notes(), section);
  return section;
}

}  // namespace montecarta
