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

/// One row a cell and reference: how far its runs are from the fixes, and how many lost the map.
TextTable reference_table(const StudyAnalysis& study);

/// One row a cell: its final map, beacons it found, particles that count, and what a run costs.
TextTable map_table(const StudyAnalysis& study);

/// One row a cell: in how many runs of how many it lost the map, and in how many it was nearer to
/// the leading reference than EKF-SLAM is on the average. Without rows where there is no reference.
TextTable baseline_table(const StudyAnalysis& study);

/// Why a recorded drive has no verdict on consistency.
std::string no_truth_sentence(const StudyAnalysis& study);

/// How to read the tables, a sentence each.
std::vector<std::string> reference_notes(const StudyAnalysis& study);

/// The cell that others are asked to beat, the first of the filter ekf_slam with complete runs;
/// nullptr where there is none.
const CellAnalysis* baseline_of(const StudyAnalysis& study);

/// What a cell says against one reference, under the names it has in files: each number over runs
/// as mean, standard error, median, least and greatest; and of its maps.
std::vector<NamedNumber> reference_numbers(const CellAnalysis& cell, std::size_t reference);

/// One row a cell and reference.
void write_references(const StudyAnalysis& study, const std::filesystem::path& path);
/// One row a fix of the leading reference, one column a cell: RMS distance over runs.
void write_reference_errors(const StudyAnalysis& study, const std::filesystem::path& path);

/// RMS over runs of the raw distance to the leading reference at each of its fixes, one curve a
/// cell; logarithmic where it spans more than two decades.
Figure reference_error_figure(const StudyAnalysis& study);
/// Raw and aligned RMS to the leading reference against the number of particles, one curve a
/// filter, with the least and the greatest run as bars; only where a filter has two numbers or
/// more.
/// Landmarks in the map over time, one curve a cell; of a drive without truth.
Figure map_size_figure(const StudyAnalysis& study);

/// All of the above that have something to show.
std::vector<Figure> reference_figures(const StudyAnalysis& study);

}  // namespace montecarta::analysis
