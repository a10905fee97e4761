// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/figure.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// One row for each cell and reference: distances to the fixes, and runs that lost the map.
TextTable reference_table(const StudyAnalysis& study);

/// One row for each cell: its final map, beacons found, effective particles and cost of a run.
TextTable map_table(const StudyAnalysis& study);

/// One row for each cell: runs that lost the map, and runs that were nearer to the leading
/// reference than EKF-SLAM is on average. No rows if there is no reference.
TextTable baseline_table(const StudyAnalysis& study);

/// Why a recorded drive has no verdict on consistency.
std::string no_truth_sentence(const StudyAnalysis& study);

/// Notes on the tables.
std::vector<std::string> reference_notes(const StudyAnalysis& study);

/// The baseline: the first cell of the filter ekf_slam with complete runs; nullptr if there is
/// none.
const CellAnalysis* baseline_of(const StudyAnalysis& study);

/// Numbers of a cell for one reference, named as in files: each over runs as mean, standard error,
/// median, least and greatest; and the numbers of its maps.
std::vector<NamedNumber> reference_numbers(const CellAnalysis& cell, std::size_t reference);

/// One row for each cell and reference.
void write_references(const StudyAnalysis& study, const std::filesystem::path& path);
/// One row for each fix of the leading reference, one column for each cell: RMS distance over runs.
void write_reference_errors(const StudyAnalysis& study, const std::filesystem::path& path);

/// RMS over runs of the raw distance to the leading reference at each fix, one curve for each cell;
/// logarithmic if it spans more than two decades.
Figure reference_error_figure(const StudyAnalysis& study);
/// Landmarks in the map over time, one curve for each cell.
Figure map_size_figure(const StudyAnalysis& study);

/// The figures above that have data.
std::vector<Figure> reference_figures(const StudyAnalysis& study);

}  // namespace montecarta::analysis
