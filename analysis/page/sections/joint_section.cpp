// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/sections.hpp"
#include "analysis/tables/joint_table.hpp"

namespace montecarta {

Section joint_section(const StudyAnalysis& study) {
  const std::vector<std::string> notes = joint_notes(study);
  if (notes.empty()) return {};
  Section section{"Pose and map together"};
  add_table("joint_nees", joint_table(study), section);
  add_notes(notes, section);
  return section;
}

}  // namespace montecarta
