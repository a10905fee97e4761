// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

namespace montecarta::analysis {

/// The section of this name in a report; empty where there is none.
inline Section reported_section(const StudyAnalysis& study, const std::string& name) {
  const std::vector<Section> all = sections_of(study);
  const auto found = std::ranges::find(all, name, &Section::name);
  return found == all.end() ? Section{name, ""} : *found;
}

/// The first table of that section; without rows where there is none.
inline TextTable reported_table(const StudyAnalysis& study, const std::string& section) {
  for (const Section::Block& block : reported_section(study, section).blocks) {
    if (const auto* table = std::get_if<Section::Table>(&block)) return table->table;
  }
  return {};
}

/// The figure of this name; without data where there is none.
inline Figure reported_figure(const StudyAnalysis& study, const std::string& name) {
  const std::vector<Figure> all = figures_of(study);
  const auto found = std::ranges::find(all, name, &Figure::name);
  return found == all.end() ? Figure{name, "", ""} : *found;
}

/// The notes of that section.
inline std::vector<std::string> reported_notes(const StudyAnalysis& study,
                                               const std::string& section) {
  std::vector<std::string> notes;
  for (const Section::Block& block : reported_section(study, section).blocks) {
    if (const auto* note = std::get_if<Section::Note>(&block)) notes.push_back(note->text);
  }
  return notes;
}

}  // namespace montecarta::analysis
