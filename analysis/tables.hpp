// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study_analysis.hpp"

#include <filesystem>
#include <iosfwd>
#include <string>

namespace montecarta {

/// The table of a terminal: failed runs first, then one row a cell with its verdict.
void print_tables(std::ostream& out, const StudyAnalysis& study);

/// Writes failures.csv, cells.csv (one row a cell), consistency.csv (one row a cell and definition
/// of error and covariance) and, for each cell, series_<label>.csv (one row
/// a scan) into `directory`, which is made where it is missing. Throws RunError naming the file
/// that cannot be written.
void write_csv(const StudyAnalysis& study, const std::filesystem::path& directory);

/// The verdict table for \input in a LaTeX document with the package booktabs.
std::string latex_table(const StudyAnalysis& study);

/// Writes everything as HDF5: one group a cell below /cells, series over the scale `time`. Replaces
/// `path`. Throws RunError where it cannot.
void write_analysis_file(const StudyAnalysis& study, const std::filesystem::path& path);

}  // namespace montecarta
