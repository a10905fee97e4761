// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"

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

}  // namespace montecarta::analysis
