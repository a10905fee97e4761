// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// What a cell of a file that 'montecarta judge' made says of its state, by its settings; the pose
/// in the plane of all other cells.
ImportedState imported_state(const StoredCell& cell);

/// "x, y, heading".
std::string components_text(const StudyAnalysis& study);

/// Of imported estimates, one sentence each: in which convention the error is, and of each cell how
/// many covariances were no covariances. Empty for filters of ours.
std::vector<std::string> imported_notes(const StudyAnalysis& study);

}  // namespace montecarta::analysis
