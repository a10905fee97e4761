// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/figure.hpp"

#include <vector>

namespace montecarta::analysis {

/// RMS over runs of the raw distance to the leading reference at each of its fixes, one curve a
/// cell; logarithmic where it spans more than two decades.
Figure reference_error_figure(const StudyAnalysis& study);
/// Raw and aligned RMS to the leading reference against the number of particles, one curve a
/// filter, with the least and the greatest run as bars; only where a filter has two numbers or
/// more.
Figure particles_figure(const StudyAnalysis& study);
/// Landmarks in the map over time, one curve a cell; of a drive without truth.
Figure map_size_figure(const StudyAnalysis& study);

/// All of the above that have something to show.
std::vector<Figure> reference_figures(const StudyAnalysis& study);

}  // namespace montecarta::analysis
