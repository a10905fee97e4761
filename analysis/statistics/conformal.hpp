// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// The value that a further number does not exceed with a probability of at least `level`, if it is
/// exchangeable with these `values`, whatever their law (STATISTICS 23): the ceil((n + 1) level)-th
/// smallest of them; infinite if there are too few.
double conformal_bound(std::vector<double> values, double level);

/// The smallest number of values of which conformal_bound() may be finite: 19 at a level of 95 %.
std::size_t fewest_for_bound(double level);

}  // namespace montecarta::analysis
