// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"
#include "analysis/study/text_table.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Plain text as LaTeX prints it: special characters escaped, +- set as a symbol.
std::string latex_escape(const std::string& text);

/// A tabular in booktabs style, without float or caption.
std::string latex_tabular(const TextTable& table);

/// The tabular of latex_tabular() below a comment that names the study.
std::string latex_table(const StudyAnalysis& study, const TextTable& table);

/// Writes failures.csv, cells.csv (one row for each cell), consistency.csv (one row for each cell
/// and definition of error and covariance), runs.csv (the scores of every complete run), the files
/// of metrics that apply (Metric::files) and, for each cell, series_<label>.csv (one row for each
/// scan) into `directory`, which is made if it is missing. Throws RunError naming the file that
/// cannot be written.
void write_csv(const StudyAnalysis& study, const std::filesystem::path& directory);

/// Names of the files that write_csv() makes if the cells have these labels.
std::vector<std::string> csv_names(const std::vector<std::string>& labels);

}  // namespace montecarta::analysis
