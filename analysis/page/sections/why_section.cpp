// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"
#include "analysis/tables/why_tables.hpp"

namespace montecarta {

Section why_section(const StudyAnalysis& study) {
  const TextTable table = why_table(study);
  if (table.rows.empty()) return {};
  Section section{"Why?"};
  add_table("why", table, section);
  add_notes(why_notes(study), section);
  return section;
}

}  // namespace montecarta
