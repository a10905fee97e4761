// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_criteria.hpp"
#include "engine/records/result_file.hpp"

namespace montecarta::analysis {

/// The criteria by which `file` is judged at `level`. The file must outlive them.
RunCriteria criteria_of(const ResultFile& file, double level, double within = kUsualMargin);

}  // namespace montecarta::analysis
