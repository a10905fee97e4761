// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/section.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/study_comparison.hpp"
#include "analysis/study/text_table.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/result_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::analysis {

// These functions make the parts of a report that belong to no metric.

/// The page's heading: the name of the study, and how much of it the file holds.
Section title_section(const StudyAnalysis& study);
/// The failed runs, with reasons.
Section failure_section(const StudyAnalysis& study);
/// A comparison of every cell with the first one, if two cells have truth.
Section comparison_section(const StudyAnalysis& study, const StudyComparison& comparison);
/// The notes of sections without other content: the missing data, and the columns to record.
Section missing_section(const std::vector<Section>& sections);
/// The study file, the scenario and the provenance.
Section origin_section(const ResultFile& file, const StudyAnalysis& study);

/// Writes index.html with these sections in their order, folded or open, and their tables below
/// tables/ in `directory`. Their figures must be drawn there already (draw()).
void write_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                const std::filesystem::path& directory);

/// A table as Markdown, special characters escaped; numbers are set to the right.
std::string markdown_table(const TextTable& table);

/// A report in one short page of Markdown: the study, where and when it ran, failed runs, the
/// tables of the terminal, the first figure over time (figures/NAME.svg) and, if a paper is
/// reproduced, its numbers beside the measured ones. `sections` are in the order of reading.
std::string markdown_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                          const TextPairs& provenance);

}  // namespace montecarta::analysis
