// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/cell_comparison.hpp"
#include "analysis/comparison/pareto.hpp"
#include "analysis/metrics/verdict_table.hpp"

#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// One row a cell and score: the difference from the baseline and its tests.
TextTable comparison_table(const Comparisons& comparisons);
/// One row and one column a cell: in what share of runs the row beats the column.
TextTable win_table(const WinMatrix& matrix, double level);
/// One row a cell: what it costs and what it gives.
TextTable pareto_table(std::span<const CellValue> values);

/// Each table's meaning, a sentence each, for someone who never heard of a p value.
std::vector<std::string> comparison_notes(const StudyAnalysis& study,
                                          const Comparisons& comparisons);
std::string win_note(double level);
std::string pareto_note();

}  // namespace montecarta::analysis
