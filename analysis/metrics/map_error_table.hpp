// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"

#include <string>
#include <vector>

namespace montecarta {

/// Whether any cell of a simulation has final maps to judge.
bool has_map_errors(const StudyAnalysis& study);

/// One row a cell: how far its final maps are from the true landmarks. Without rows where no cell
/// has a map.
TextTable map_error_table(const StudyAnalysis& study);

/// How to read it, a sentence each, or why there are no numbers.
std::vector<std::string> map_error_notes(const StudyAnalysis& study);

/// What the Cramer-Rao bound and efficiency say, or why there is none.
std::vector<std::string> bound_notes(const StudyAnalysis& study);

}  // namespace montecarta
