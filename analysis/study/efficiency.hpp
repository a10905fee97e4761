// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/cramer_rao.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/cell_analysis.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// The bound divided by the error: 1 is the best that a filter without bias can reach. NaN if there
/// is no bound (a linearised reference is none) or no error.
struct Efficiency {
  /// Ratios of root mean squares over scans; the error's is also over runs.
  double position = kNaN;
  double heading = kNaN;
  /// Ratio for the landmarks in the map at the end; needs known association.
  double map = kNaN;
};

Efficiency efficiency_of(const CellAnalysis& cell, const CramerRaoBound& bound);

/// Notes on the bound and on the efficiency, or the reason why there is none.
std::vector<std::string> bound_notes(const CramerRaoBound& bound);

}  // namespace montecarta::analysis
