// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"

#include <cstddef>
#include <iosfwd>
#include <string>

namespace montecarta::analysis {

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

}  // namespace montecarta::analysis
