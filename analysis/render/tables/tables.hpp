// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"
#include "analysis/study/verdict_table.hpp"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Plain text as LaTeX prints it: special characters escaped, +- set as a symbol.
std::string latex_escape(const std::string& text);

/// A tabular in booktabs style, without float or caption.
std::string latex_tabular(const TextTable& table);

/// The same below a comment with the name of its study.
std::string latex_table(const StudyAnalysis& study, const TextTable& table);

/// The verdict on each cell in a sentence. This and the following are for a terminal of `width`
/// columns.
void print_sentences(std::ostream& out, const StudyAnalysis& study, std::size_t width);

/// Failed runs, sentences and one table with a row for each cell and its verdict. For a recorded
/// drive without a true path, the tables of its references.
void print_summary(std::ostream& out, const StudyAnalysis& study, std::size_t width);

/// Failed runs, sentences and all tables.
void print_all(std::ostream& out, const StudyAnalysis& study, std::size_t width);

/// One table and how to read it. Throws StudyError if no table has this name.
void print_named(std::ostream& out, const StudyAnalysis& study, const std::string& name,
                 std::size_t width);

/// Writes failures.csv, cells.csv (one row for each cell), consistency.csv (one row for each cell
/// and definition of error and covariance), runs.csv (the scores of every complete run), the files
/// of metrics that apply (Metric::files) and, for each cell, series_<label>.csv (one row for each
/// scan) into `directory`, which is made if it is missing. Throws RunError naming the file that
/// cannot be written.
void write_csv(const StudyAnalysis& study, const std::filesystem::path& directory);

/// Names of the files that write_csv() makes of cells with these labels.
std::vector<std::string> csv_names(const std::vector<std::string>& labels);

/// Writes everything as HDF5: one group for each cell below /cells, series over the scale `time`.
/// Replaces `path` when all is written. Throws RunError if that fails, and leaves the old file.
void write_analysis_file(const StudyAnalysis& study, const std::filesystem::path& path);

}  // namespace montecarta::analysis
