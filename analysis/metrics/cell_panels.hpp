// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/figure.hpp"

#include <functional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// The label of a cell without its number of particles: "fastslam2_gps" of "fastslam2_m100_gps".
std::string label_without_particles(const CellAnalysis& cell);

/// These labels of all cells, each once. If colours stand for filters, the index in this list
/// selects the colour.
std::vector<std::string> filter_labels(const StudyAnalysis& study);

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

}  // namespace montecarta::analysis
