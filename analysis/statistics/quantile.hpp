// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace montecarta::analysis {

/// The value below which a share `p` of at least one value lies, interpolated between its
/// neighbours: value k of n sorted values, from 0, has the share (k + 1/2) / n. Sorts `values` only
/// as far as needed.
double quantile_of(std::vector<double>& values, double p);

}  // namespace montecarta::analysis
