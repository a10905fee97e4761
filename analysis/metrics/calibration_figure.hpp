// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/figure.hpp"

#include <vector>

namespace montecarta {

/// Histograms of where the truth lies in what filters hold for possible, at the end of the run: by
/// their Gaussian, and by their particles where they are stored; a row for each of the first eight
/// cells. Without data where nothing is judged.
std::vector<Figure> calibration_figures(const StudyAnalysis& study);

}  // namespace montecarta
