// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/comparison/pareto.hpp"
#include "analysis/output/figure.hpp"

#include <span>

namespace montecarta::analysis {

/// Position RMSE and NEES distance against CPU time of a run, a labelled point a cell, with both
/// Pareto fronts. Without data where fewer than two cells have a cost.
Figure pareto_figure(std::span<const CellValue> values);

}  // namespace montecarta::analysis
