// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/cell_spec.hpp"

#include <algorithm>
#include <cctype>

namespace montecarta::experiments {
namespace {

/// Whether nothing but its label can tell a cell from others of its filter.
bool is_known_by_label(const CellSpec& cell) {
  return std::ranges::any_of(
      cell.filter->options, [](const Option& option) { return option.kind == Option::Kind::text; });
}

/// A value as part of a label: 0.75 -> 0p75, -1 -> m1.
std::string label_part(std::string text) {
  for (char& c : text) {
    if (c == '-') c = 'm';
    if (c != '_' && std::isalnum(static_cast<unsigned char>(c)) == 0) c = 'p';
  }
  return text;
}

/// Whether cells of the same filter differ in their option number `i`, other than by a text, which
/// makes no label.
bool distinguishes(const std::vector<CellSpec>& cells, const CellSpec& cell, std::size_t i) {
  if (cell.filter->options[i].kind == Option::Kind::text) return false;
  return std::ranges::any_of(cells, [&](const CellSpec& other) {
    return other.filter == cell.filter && other.options[i].second != cell.options[i].second;
  });
}

void describe(const std::vector<CellSpec>& cells, const CellSpec& cell, std::string& label,
              std::string& distinction) {
  label = cell.filter->name;
  for (std::size_t i = 0; i < cell.options.size(); ++i) {
    const auto& [key, value] = cell.options[i];
    const bool particles = key == "particles";
    if (!particles && !distinguishes(cells, cell, i)) continue;
    label += particles ? "_m" + value : "_" + key + "_" + label_part(value);
    distinction +=
        (distinction.empty() ? "" : ", ") + (particles ? value + " particles" : key + " " + value);
  }
  for (const auto& [key, factor] : cell.mismatch) {
    label += "_" + key + "_" + label_part(factor);
    distinction += (distinction.empty() ? "" : ", ") + ("believes " + key + " x " + factor);
  }
}

}  // namespace

void label_cells(std::vector<CellSpec>& cells) {
  for (CellSpec& cell : cells) {
    std::string label;
    describe(cells, cell, label, cell.distinction);
    if (cell.label.empty()) cell.label = label;
    if (cell.distinction.empty() && is_known_by_label(cell)) cell.distinction = cell.label;
  }
}

}  // namespace montecarta::experiments
