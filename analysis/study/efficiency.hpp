// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/cramer_rao.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/study/cell_analysis.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// The bound divided by the error: 1 is as good as any filter without bias can be. NaN if there is
/// no bound (a linearised reference is none) or no error.
struct Efficiency {
  /// Root mean squares over scans, that of the error also over runs.
  double position = kNaN;
  double heading = kNaN;
  /// For the landmarks in the map at the end; needs known association.
  double map = kNaN;
};

Efficiency efficiency_of(const CellAnalysis& cell, const CramerRaoBound& bound);

/// Notes on the bound and on the efficiency, or the reason why there is none.
std::vector<std::string> bound_notes(const CramerRaoBound& bound);

}  // namespace montecarta::analysis
