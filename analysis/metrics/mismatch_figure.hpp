// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/figure.hpp"

namespace montecarta {

/// ANEES per component over what filters believe of motion and sensor, a map of colours for each
/// filter. Without data where no filter has two factors of each kind.
Figure mismatch_figure(const StudyAnalysis& study);

}  // namespace montecarta
