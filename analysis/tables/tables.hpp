// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Plain text as LaTeX prints it: special characters escaped, +- set as a symbol.
std::string latex_escape(const std::string& text);

/// A tabular in booktabs style, without float or caption.
std::string latex_tabular(const TextTable& table);

/// The same below a comment that says which study it is of.
std::string latex_table(const StudyAnalysis& study, const TextTable& table);

/// Whether sentences say how tables are read.
enum class Explanations { hidden, shown };

/// The tables of a terminal: failed runs first, then one row a cell with its verdict; of a recorded
/// drive, one row a cell and reference instead.
void print_tables(std::ostream& out, const StudyAnalysis& study,
                  Explanations explanations = Explanations::hidden);

/// Writes failures.csv, cells.csv (one row a cell), consistency.csv (one row a cell and definition
/// of error and covariance), runs.csv (the scores of every complete run), the files of metrics that
/// apply (Metric::files)
/// and, for each cell, series_<label>.csv (one row a scan) into `directory`, which is made where it
/// is missing. Throws RunError naming the file that cannot be written.
void write_csv(const StudyAnalysis& study, const std::filesystem::path& directory);

/// Names of the files that write_csv() makes of cells with these labels.
std::vector<std::string> csv_names(const std::vector<std::string>& labels);

/// Writes everything as HDF5: one group a cell below /cells, series over the scale `time`. Replaces
/// `path` when all is written. Throws RunError where it cannot, and leaves what was there.
void write_analysis_file(const StudyAnalysis& study, const std::filesystem::path& path);

}  // namespace montecarta::analysis
