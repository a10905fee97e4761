// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// Sentences on events of a recorded drive that change how its verdicts are to be read:
/// filters without a landmark, gross outliers, a reference with the headings of the odometry, and
/// fixes that are left out. Printed before the verdicts. Empty if the truth is known.
std::vector<std::string> drive_facts(const StudyAnalysis& study);

}  // namespace montecarta::analysis
