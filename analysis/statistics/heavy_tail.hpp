// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace montecarta::analysis {

/// Whether no interval of the mean of such values is to be trusted (STATISTICS 6): a single value
/// may decide the mean, or values of that size may lie where none was drawn yet. Of a log-normal
/// with a deviation of 1.5 nearly always, of an exponential in half of samples of 20 and in 7 % of
/// samples of 100; never of fewer than three values, of equal ones or where one is not finite.
bool is_heavy_tailed(std::span<const double> values);

}  // namespace montecarta::analysis
