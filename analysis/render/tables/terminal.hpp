// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/study_analysis.hpp"

#include <cstddef>
#include <iosfwd>
#include <string>

namespace montecarta::analysis {

/// Prints what happened on a recorded drive, then the verdict on each cell in a sentence, for a
/// terminal of `width` columns like the functions below.
void print_sentences(std::ostream& out, const StudyAnalysis& study, std::size_t width);

/// Prints the failed runs, the sentences and one table with a row for each cell and its verdict.
/// For a recorded drive without a true path, prints the tables of its references instead of that
/// table.
void print_summary(std::ostream& out, const StudyAnalysis& study, std::size_t width);

/// Prints the failed runs, the sentences and all tables.
void print_all(std::ostream& out, const StudyAnalysis& study, std::size_t width);

/// Prints one table and how to read it. Throws StudyError if no table has this name.
void print_named(std::ostream& out, const StudyAnalysis& study, const std::string& name,
                 std::size_t width);

}  // namespace montecarta::analysis
