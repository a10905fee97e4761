// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/named_rows.hpp"

#include <string>
#include <vector>

namespace montecarta {

/// Everything a cell has over scans; what is not stored is absent.
std::vector<NamedSeries> series_of(const CellAnalysis& cell);

/// Everything a cell says in single numbers but its NEES tests: the same names for every cell, NaN
/// where one does not apply.
std::vector<NamedNumber> numbers_of(const CellAnalysis& cell);

/// One NEES test in single numbers. The band is that of all complete runs.
std::vector<NamedNumber> numbers_of(const CellAnalysis& cell, const NeesResult& nees, double level);

}  // namespace montecarta
