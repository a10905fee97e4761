// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// What happened on a recorded drive and changes how its verdicts are to be read, a sentence each:
/// filters without a landmark, gross outliers, a reference with the headings of the odometry, and
/// fixes that are left out. Printed before the verdicts. Empty if the truth is known.
std::vector<std::string> drive_facts(const StudyAnalysis& study);

}  // namespace montecarta::analysis
