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

// The parts of a report that belong to no metric.

/// The subject of the study, for someone who knows nothing of it.
std::string studied_sentence(const StudyAnalysis& study);
/// The page's heading: which study, how much of it.
Section title_section(const StudyAnalysis& study);
/// The failed runs, with reasons.
Section failure_section(const StudyAnalysis& study);
/// Compares every cell with the first one, if two cells have truth.
Section comparison_section(const StudyAnalysis& study, const StudyComparison& comparison);
/// The notes of sections that have nothing else: the missing data, and the columns to record.
Section missing_section(const std::vector<Section>& sections);
/// Study, scenario and provenance.
Section origin_section(const ResultFile& file, const StudyAnalysis& study);

/// Writes index.html with these sections in their order, folded or open, and their tables below
/// tables/ into `directory`, below which their figures are drawn already (draw()).
void write_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                const std::filesystem::path& directory);

/// A table as Markdown, special characters escaped; numbers are set to the right.
std::string markdown_table(const TextTable& table);

/// A report in one short page of Markdown: the study, where and when it ran, failed runs, the
/// tables of the terminal, the first figure over time (figures/NAME.svg) and, where a paper is
/// repeated, its numbers beside the measured ones. `sections` in their order of reading.
std::string markdown_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                          const TextPairs& provenance);

}  // namespace montecarta::analysis
