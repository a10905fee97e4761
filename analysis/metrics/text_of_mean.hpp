// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// The mean of `values`, one a run, with its `interval`. Where they have a heavy tail, of which no
/// interval of the mean holds, the mean says so and the median over runs follows with its interval
/// at `level`. All times `factor`.
std::string text_of_mean(const std::vector<double>& values, double mean, const Interval& interval,
                         double factor, double level);

}  // namespace montecarta::analysis
