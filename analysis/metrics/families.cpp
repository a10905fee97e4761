// SPDX-License-Identifier: BSD-3-Clause
// All single tests on which the verdict rests, as a file.
#include "analysis/study/cell_report.hpp"
#include "analysis/study/verdict_table.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

TextTable family_table(const StudyAnalysis& study) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) {
    for (const FamilyTest& test : cell.verdict.families) {
      const Member& member = test.strongest();
      table.add({{"cell", cell.label, Align::left},
                 {"family", name_of(test.family), Align::left},
                 {"p", readable(test.p, 2)},
                 {"farthest from right", name_of(member), Align::left},
                 {"level", level_text(cell.verdict.level)},
                 {"estimate and its interval",
                  is_ratio(test.family) ? ratio_with_interval(member.estimate, member.interval)
                                        : with_interval(member.estimate, member.interval)},
                 {"shown", test.is_rejected ? "yes" : "no", Align::left}});
    }
  }
  return table;
}

std::vector<Section> families_sections(const StudyAnalysis& study) {
  if (!study.has_truth) return {};
  std::size_t tests = 0;
  std::ptrdiff_t rejected = 0;
  for (const CellAnalysis& cell : study.cells) {
    tests += cell.verdict.families.size();
    rejected += std::ranges::count_if(cell.verdict.families, &FamilyTest::is_rejected);
  }
  Section section = section_of(
      "families", {{"rejected", std::to_string(rejected)}, {"tests", std::to_string(tests)}});
  section.is_for_terminal = false;
  return table_section(section, family_table(study));
}

/// Makes a file with one row for each member of each family, including the family of scans.
Frame families_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    for (const FamilyTest& test : cell.verdict.families) {
      for (const Member& member : test.members) {
        Frame::Row row = family_row(test, member);
        row.emplace_back("level", "1", cell.verdict.level);
        frame.add(
            {{"cell", cell.label}, {"family", key_of(test.family)}, {"member", name_of(member)}},
            row);
      }
    }
  }
  return frame;
}

}  // namespace

Metric families_metric() {
  return {.sections = families_sections, .files = {{"families.csv", families_frame}}};
}

}  // namespace montecarta::analysis
