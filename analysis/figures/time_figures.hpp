// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/figure.hpp"
#include "analysis/metrics/study_analysis.hpp"

#include <vector>

namespace montecarta {

/// ANEES of the pose over time, one curve a cell, with its band.
Figure anees_figure(const StudyAnalysis& study);
/// ANEES of position and of heading, a panel each.
Figure anees_parts_figure(const StudyAnalysis& study);
/// RMSE over runs of position and of heading over time, a panel each.
Figure rmse_figure(const StudyAnalysis& study);
/// Distinct ancestors over time: in the last resampling, 10 s back, at the start.
Figure diversity_figure(const StudyAnalysis& study);
/// Effective share of the particles over time.
Figure ess_figure(const StudyAnalysis& study);

/// All of the above that have something to show.
std::vector<Figure> time_figures(const StudyAnalysis& study);

}  // namespace montecarta
