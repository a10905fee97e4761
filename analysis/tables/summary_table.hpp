// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/text_table.hpp"

namespace montecarta::analysis {

/// One row a cell, narrow enough for a terminal: complete runs, verdict, NEES ratio with its
/// interval, RMSE of position and heading, ancestors and cost. Columns without a number are left
/// out, and so are runs if every cell completed all of the file.
TextTable summary_table(const StudyAnalysis& study);

}  // namespace montecarta::analysis
