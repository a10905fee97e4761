// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/study_comparison.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/page/section.hpp"
#include "engine/records/result_file.hpp"

#include <cstdint>
#include <optional>

namespace montecarta {

/// The page's heading: which study, how much of it.
Section title_section(const StudyAnalysis& study);
/// Which runs failed, and why.
Section failure_section(const StudyAnalysis& study);
/// What is consistent, until when, and how accurate; not of a recorded drive.
Section verdict_section(const StudyAnalysis& study);
/// How far the final maps are from the true landmarks; not of a recorded drive.
Section map_section(const StudyAnalysis& study);
/// Whether filters are right about pose and map together, where that is stored.
Section joint_section(const StudyAnalysis& study);
/// Where the truth lies in what filters hold for possible; only where the noise is matched.
Section calibration_section(const StudyAnalysis& study);
/// A recorded drive judged by its references.
Section reference_section(const StudyAnalysis& study);
/// A player that replays one run, chosen as chosen_run() does, as far as the file holds it.
Section replay_section(const ResultFile& file, std::optional<std::uint64_t> run);
/// What became of the detections, where that was counted.
Section association_section(const StudyAnalysis& study);
/// Every cell beside the first one, and what each is worth; where two cells have truth.
Section comparison_section(const StudyAnalysis& study, const StudyComparison& comparison);
/// Every definition of error and covariance.
Section consistency_section(const StudyAnalysis& study);
/// Bias or scatter, in which direction, how far.
Section why_section(const StudyAnalysis& study);
/// Size and whiteness of the innovations.
Section innovation_section(const StudyAnalysis& study);
/// Effective particles and ancestry.
Section diversity_section(const StudyAnalysis& study);
/// Study, scenario and provenance.
Section origin_section(const ResultFile& file, const StudyAnalysis& study);
/// What a paper printed beside what was measured.
Section printed_section(const StudyAnalysis& study);

}  // namespace montecarta
