// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"
#include "analysis/tables/map_error_table.hpp"

namespace montecarta {

Section map_section(const StudyAnalysis& study) {
  const std::vector<std::string> notes = map_error_notes(study);
  if (notes.empty()) return {};
  Section section{"Map"};
  add_table("map_errors", map_error_table(study), section);
  add_notes(notes, section);
  return section;
}

}  // namespace montecarta
