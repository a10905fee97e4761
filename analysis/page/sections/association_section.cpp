// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"

namespace montecarta {

Section association_section(const StudyAnalysis& study) {
  const TextTable table = association_table(study);
  if (table.rows.empty()) return {};
  Section section{"Association"};
  add_table("association", table, section);
  add_notes(association_notes(), section);
  return section;
}

}  // namespace montecarta
