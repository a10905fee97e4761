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

/// The least and the greatest number of all cells with their labels, for the summary of a section:
/// "1.62 (ekf_slam) to 717 (fastslam2)". One number if both read the same; "-" without any.
std::string range_over_cells(
    const StudyAnalysis& study, const CellNumber& number_of,
    const NumberText& text_of = [](double value) { return readable(value); });

/// Columns of a cell behind its label; empty where it has no row.
using CellEntries = std::function<std::vector<TextTable::Entry>(const CellAnalysis&)>;

/// One row for each cell that has entries.
TextTable cell_table(const StudyAnalysis& study, const CellEntries& entries_of);

/// A section with a table of the same name and the notes of its prose; none if the table has no
/// rows.
std::vector<Section> table_section(Section section, const TextTable& table,
                                   const Values& notes = {});

/// The values of a cell over time; empty where it has none.
using CellValues = std::function<std::vector<double>(const CellAnalysis&)>;

/// One for each cell that has values: a cell keeps its colour in every figure.
std::vector<Curve> cell_curves(const StudyAnalysis& study, const CellValues& values_of);

/// All values times a factor.
std::vector<double> scaled(std::vector<double> values, double factor);

/// One curve for each cell that has values in one panel like `blank`; where there are more than can
/// be told apart, one panel for each number of particles (cells without particles in all of them),
/// in which colours stand for filters. None where no cell has values.
std::vector<Panel> cell_panels(const StudyAnalysis& study, const Panel& blank,
                               const CellValues& values_of);

/// The figure with these panels over the scans.
Figure cell_figure(const StudyAnalysis& study, Figure figure, const Panel& blank,
                   const CellValues& values_of);

}  // namespace montecarta::analysis
