// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/verdict_table.hpp"

#include <string>

namespace montecarta::analysis {

/// Plain text as LaTeX prints it: special characters escaped, +- set as a symbol.
std::string latex_escape(const std::string& text);

/// A tabular in booktabs style, without float or caption.
std::string latex_tabular(const TextTable& table);

/// The same below a comment that says which study it is of.
std::string latex_table(const StudyAnalysis& study, const TextTable& table);

}  // namespace montecarta::analysis
