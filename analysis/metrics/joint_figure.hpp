// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/figure.hpp"

namespace montecarta {

/// NEES of pose and map together at the scans at which joint estimates are stored, with the band of
/// a right filter. Without data where no cell was judged by them.
Figure joint_figure(const StudyAnalysis& study);

}  // namespace montecarta
