// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/number_text.hpp"

#include <functional>
#include <string>

namespace montecarta::analysis {

/// A number of a cell; NaN if it has none.
using CellNumber = std::function<double(const CellAnalysis&)>;
using NumberText = std::function<std::string(double)>;

/// The least and the greatest number of all cells with their labels, for the summary of a section:
/// "1.62 (ekf_slam) to 717 (fastslam2)". One number if both read the same; "-" without any.
std::string range_over_cells(
    const StudyAnalysis& study, const CellNumber& number_of,
    const NumberText& text_of = [](double value) { return readable(value); });

}  // namespace montecarta::analysis
