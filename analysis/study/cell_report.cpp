// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/cell_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostCurves = 8;

/// A cell that has a curve.
struct DrawnCurve {
  const CellAnalysis* cell;
  Curve curve;
};

std::vector<DrawnCurve> drawn_cells(const StudyAnalysis& study, const CellValues& values_of) {
  std::vector<DrawnCurve> drawn;
  for (std::size_t i = 0; i < study.cells.size(); ++i) {
    std::vector<double> values = values_of(study.cells[i]);
    if (values.empty()) continue;
    drawn.push_back({&study.cells[i], {study.cells[i].label, i, std::move(values)}});
  }
  return drawn;
}

/// The label of a cell without its number of particles: "fastslam2_gps" of "fastslam2_m100_gps".
std::string label_without_particles(const CellAnalysis& cell) {
  const std::string part = "_m" + std::to_string(cell.particles);
  std::string label = cell.label;
  for (std::size_t at = 0; (at = label.find(part, at)) != label.npos; ++at) {
    const std::size_t end = at + part.size();
    if (end != label.size() && label[end] != '_') continue;
    return label.erase(at, part.size());
  }
  return label;
}

/// The labels of all cells without their numbers of particles, each once.
std::vector<std::string> filter_labels(const StudyAnalysis& study) {
  std::vector<std::string> labels;
  for (const CellAnalysis& cell : study.cells) {
    const std::string label = label_without_particles(cell);
    if (std::ranges::find(labels, label) == labels.end()) labels.push_back(label);
  }
  return labels;
}

/// A panel with a curve for every filter, so that one legend serves all panels; a curve has no
/// values if its filter has no cell with this number of particles.
Panel panel_of(std::size_t particles, const std::vector<DrawnCurve>& drawn,
               const std::vector<std::string>& filters, const Panel& blank) {
  Panel panel = blank;
  panel.name += "_m" + std::to_string(particles);
  panel.label = blank.label + ", M = " + std::to_string(particles);
  const std::vector<double> nothing(drawn.front().curve.values.size(), kNaN);
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const auto found = std::ranges::find_if(drawn, [&](const DrawnCurve& one) {
      const bool here = one.cell->particles == 0 || one.cell->particles == particles;
      return here && label_without_particles(*one.cell) == filters[i];
    });
    panel.curves.push_back({filters[i], i, found == drawn.end() ? nothing : found->curve.values});
  }
  return panel;
}

}  // namespace

std::string range_over_cells(const StudyAnalysis& study, const CellNumber& number_of,
                             const NumberText& text_of) {
  const CellAnalysis* least = nullptr;
  const CellAnalysis* greatest = nullptr;
  for (const CellAnalysis& cell : study.cells) {
    const double number = number_of(cell);
    if (std::isnan(number)) continue;
    if (least == nullptr || number < number_of(*least)) least = &cell;
    if (greatest == nullptr || number > number_of(*greatest)) greatest = &cell;
  }
  if (least == nullptr) return "-";
  const std::string from = text_of(number_of(*least)), to = text_of(number_of(*greatest));
  return from == to ? from
                    : from + " (" + least->label + ") to " + to + " (" + greatest->label + ")";
}

TextTable cell_table(const StudyAnalysis& study, const CellEntries& entries_of) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) {
    std::vector<TextTable::Entry> row = entries_of(cell);
    if (row.empty()) continue;
    row.insert(row.begin(), {"cell", cell.label, Align::left});
    table.add(row);
  }
  return table;
}

std::vector<Section> table_section(Section section, const TextTable& table, const Values& notes) {
  if (table.rows.empty()) return {};
  section.add(section.name, table);
  section.add_notes("notes", notes);
  return {section};
}

std::vector<Curve> cell_curves(const StudyAnalysis& study, const CellValues& values_of) {
  std::vector<Curve> curves;
  for (DrawnCurve& one : drawn_cells(study, values_of)) curves.push_back(std::move(one.curve));
  return curves;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

std::vector<Panel> cell_panels(const StudyAnalysis& study, const Panel& blank,
                               const CellValues& values_of) {
  const std::vector<DrawnCurve> drawn = drawn_cells(study, values_of);
  if (drawn.empty()) return {};
  std::set<std::size_t> numbers;
  for (const DrawnCurve& one : drawn) {
    if (one.cell->particles > 0) numbers.insert(one.cell->particles);
  }
  std::vector<Panel> panels;
  if (drawn.size() > kMostCurves && numbers.size() > 1) {
    for (const std::size_t n : numbers)
      panels.push_back(panel_of(n, drawn, filter_labels(study), blank));
    return panels;
  }
  panels.push_back(blank);
  for (const DrawnCurve& one : drawn) panels.front().curves.push_back(one.curve);
  return panels;
}

Figure cell_figure(const StudyAnalysis& study, Figure figure, const Panel& blank,
                   const CellValues& values_of) {
  add_panels(cell_panels(study, blank, values_of), study.times, figure);
  return figure;
}

}  // namespace montecarta::analysis
