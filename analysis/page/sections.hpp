// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/study_comparison.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/section.hpp"
#include "engine/records/result_file.hpp"

#include <cstdint>
#include <optional>

namespace montecarta::analysis {

// The parts of a report that belong to no metric.

/// The page's heading: which study, how much of it.
Section title_section(const StudyAnalysis& study);
/// Which runs failed, and why.
Section failure_section(const StudyAnalysis& study);
/// A player that replays one run, chosen as chosen_run() does, as far as the file holds it.
Section replay_section(const ResultFile& file, std::optional<std::uint64_t> run);
/// Every cell beside the first one, and what each is worth; where two cells have truth.
Section comparison_section(const StudyAnalysis& study, const StudyComparison& comparison);
/// Study, scenario and provenance.
Section origin_section(const ResultFile& file, const StudyAnalysis& study);
/// What a paper printed beside what was measured.
Section printed_section(const StudyAnalysis& study);

}  // namespace montecarta::analysis
