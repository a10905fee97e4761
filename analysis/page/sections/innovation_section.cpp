// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"
#include "analysis/tables/why_tables.hpp"

namespace montecarta {

Section innovation_section(const StudyAnalysis& study) {
  const TextTable table = innovation_table(study);
  if (table.rows.empty()) return {};
  Section section{"Do measurements surprise the filter?"};
  add_table("innovation", table, section);
  add_notes(innovation_notes(), section);
  return section;
}

}  // namespace montecarta
