// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/figure.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/text/number_text.hpp"

#include <functional>
#include <string>
#include <vector>

// Numbers of all cells of a study side by side: in a table, in a figure, and as a range in words.
namespace montecarta::analysis {

/// A number of a cell; NaN if it has none.
using CellNumber = std::function<double(const CellAnalysis&)>;
using NumberText = std::function<std::string(double)>;

/// The least and the greatest number over all cells with their labels, for the summary of a
/// section: "1.62 (ekf_slam) to 717 (fastslam2)". One number if both have the same text; "-"
/// without any.
std::string range_over_cells(
    const StudyAnalysis& study, const CellNumber& number_of,
    const NumberText& text_of = [](double value) { return readable(value); });

/// Columns of a cell after its label; empty if it has no row.
using CellEntries = std::function<std::vector<TextTable::Entry>(const CellAnalysis&)>;

/// A table with one row for each cell that has entries.
TextTable cell_table(const StudyAnalysis& study, const CellEntries& entries_of);

/// A section with a table of the same name and the notes of its prose; empty if the table has no
/// rows.
std::vector<Section> table_section(Section section, const TextTable& table,
                                   const Values& notes = {});

/// The values of a cell over time; empty where it has none.
using CellValues = std::function<std::vector<double>(const CellAnalysis&)>;

/// One curve for each cell that has values; a cell keeps its colour in every figure.
std::vector<Curve> cell_curves(const StudyAnalysis& study, const CellValues& values_of);

/// The values multiplied by `factor`.
std::vector<double> scaled(std::vector<double> values, double factor);

/// Panels like `blank` with a curve for each cell that has values. It is one panel; if there are
/// too many curves to distinguish, it is one panel for each number of particles (with cells without
/// particles in all of them), in which colours stand for filters. Empty if no cell has values.
std::vector<Panel> cell_panels(const StudyAnalysis& study, const Panel& blank,
                               const CellValues& values_of);

/// Adds the panels of cell_panels(), over the scans, to `figure`.
Figure cell_figure(const StudyAnalysis& study, Figure figure, const Panel& blank,
                   const CellValues& values_of);

}  // namespace montecarta::analysis
