// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/cell_range.hpp"

#include <cmath>

namespace montecarta::analysis {

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

}  // namespace montecarta::analysis
