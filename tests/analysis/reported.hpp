// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/metric.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/study_analysis.hpp"

#include <algorithm>
#include <string>
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
  const auto tables = reported_section(study, section).all<Section::Table>();
  return tables.empty() ? TextTable{} : tables.front().table;
}

/// The figure of this name; without data where there is none.
inline Figure reported_figure(const StudyAnalysis& study, const std::string& name) {
  const std::vector<Figure> all = figures_of(study);
  const auto found = std::ranges::find(all, name, &Figure::name);
  return found == all.end() ? Figure{name, "", ""} : *found;
}

/// Row `k` of a frame of numbers.
inline std::vector<double> row_of(const Frame& frame, std::size_t k) {
  std::vector<double> row;
  for (const Frame::Column& column : frame.columns) row.push_back(column.numbers.at(k));
  return row;
}

/// The notes of that section.
inline std::vector<std::string> reported_notes(const StudyAnalysis& study,
                                               const std::string& section) {
  std::vector<std::string> notes;
  for (const auto& note : reported_section(study, section).all<Section::Note>()) {
    notes.push_back(note.text);
  }
  return notes;
}

}  // namespace montecarta::analysis
