// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/figures/figure.hpp"
#include "analysis/metrics/study_analysis.hpp"

#include <vector>

namespace montecarta {

/// Share of the runs that are still right over time, each judged by itself.
Figure survival_figure(const StudyAnalysis& study);
/// Errors in the worst direction against the variance believed there, and the part that is bias.
Figure why_figure(const StudyAnalysis& study);
/// NIS per component over time.
Figure innovation_figure(const StudyAnalysis& study);
/// Correlation of the NIS over scans apart, with the band of white ones.
Figure whiteness_figure(const StudyAnalysis& study);

/// All of the above that have something to show.
std::vector<Figure> why_figures(const StudyAnalysis& study);

}  // namespace montecarta
