// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/cramer_rao.hpp"

#include <limits>
#include <string>
#include <vector>

namespace montecarta::analysis {

struct CellAnalysis;

/// How near a cell comes to the Cramer-Rao bound: 1 is as good as any filter without bias can be.
/// NaN where there is no bound (a linearised reference is none) or no error.
struct Efficiency {
  /// Bound by error, each the root of its mean square over scans, that of the error also over runs.
  double position = std::numeric_limits<double>::quiet_NaN();
  double heading = std::numeric_limits<double>::quiet_NaN();
  /// Of the landmarks in the map at the end; needs known association.
  double map = std::numeric_limits<double>::quiet_NaN();
};

Efficiency efficiency_of(const CellAnalysis& cell, const CramerRaoBound& bound);

/// What the bound and efficiency say, or why there is none.
std::vector<std::string> bound_notes(const CramerRaoBound& bound);

}  // namespace montecarta::analysis
