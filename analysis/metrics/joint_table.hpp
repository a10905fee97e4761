// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta {

/// Whether any cell was judged by its joint estimates.
bool has_joint_nees(const StudyAnalysis& study);

/// One row a cell that has joint estimates: is it right about pose and map together? Without rows
/// where none has.
TextTable joint_table(const StudyAnalysis& study);

/// How to read it, a sentence each, or why there are no numbers; nothing where none are stored.
std::vector<std::string> joint_notes(const StudyAnalysis& study);

/// One row a cell and stored scan: joint NEES per component with its bounds.
void write_joint_nees(const StudyAnalysis& study, const std::filesystem::path& path);

}  // namespace montecarta
