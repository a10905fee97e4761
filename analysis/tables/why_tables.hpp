// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/tables/verdict_table.hpp"

#include <string>
#include <vector>

namespace montecarta {

/// Why a cell is inconsistent: bias or scatter, in which direction, how far; one row a cell that
/// has a covariance and a truth.
TextTable why_table(const StudyAnalysis& study);
/// What the table means, a sentence each, as those of the next two.
std::vector<std::string> why_notes(const StudyAnalysis& study);

/// The innovations of every cell that has some: size and whiteness.
TextTable innovation_table(const StudyAnalysis& study);
std::vector<std::string> innovation_notes();

/// Effective particles, resampling and ancestry of every cell that has particles.
TextTable diversity_table(const StudyAnalysis& study);
std::vector<std::string> diversity_notes();

}  // namespace montecarta
