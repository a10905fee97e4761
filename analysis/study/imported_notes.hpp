// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// Names of the components: "x, y, heading".
std::string components_text(const StudyAnalysis& study);

/// Notes on imported estimates: the convention of the error, and the number of unusable covariances
/// of each cell. Empty for filters of this program.
std::vector<std::string> imported_notes(const StudyAnalysis& study);

}  // namespace montecarta::analysis
