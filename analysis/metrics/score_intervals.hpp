// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/cell_analysis.hpp"

namespace montecarta {

/// Fills CellAnalysis::lower and ::upper from the scores, and Consistency::average_interval of
/// every test from its runs: one bootstrap over runs at `level`.
void put_score_intervals(CellAnalysis& cell, double level);

}  // namespace montecarta
