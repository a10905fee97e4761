// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/named_rows.hpp"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace montecarta::analysis {

/// What a cell says against one reference, under the names it has in files: each number over runs
/// as mean, standard error, median, least and greatest; and of its maps.
std::vector<NamedNumber> reference_numbers(const CellAnalysis& cell, std::size_t reference);

/// One row a cell and reference.
void write_references(const StudyAnalysis& study, const std::filesystem::path& path);
/// One row a fix of the leading reference, one column a cell: RMS distance over runs.
void write_reference_errors(const StudyAnalysis& study, const std::filesystem::path& path);

}  // namespace montecarta::analysis
