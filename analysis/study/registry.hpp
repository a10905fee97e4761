// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/metric.hpp"

#include <span>
#include <vector>

namespace montecarta::analysis {

/// All metrics in the order of files; registry.cpp lists them.
std::span<const Metric> all_metrics();

/// All single numbers of a cell except those of its NEES tests.
Frame::Row numbers_of(const CellAnalysis& cell);

/// All series of a cell.
std::vector<Frame::Column> series_of(const CellAnalysis& cell);

/// All sections of the metrics.
std::vector<Section> sections_of(const StudyAnalysis& study);

std::vector<Figure> figures_of(const StudyAnalysis& study);

}  // namespace montecarta::analysis
