// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Replicates of a bootstrap over `runs`: 2000, and fewer where there are so many runs that
/// replicates hardly differ.
std::size_t bootstrap_replicates(std::size_t runs);

/// The runs that replicate `b` draws with replacement, as `runs` indices: the same in every call.
void draw_runs(std::size_t runs, std::size_t b, std::vector<std::uint32_t>& drawn);

/// Interval of the mean over infinitely many runs at `level`, given one value for each run.
/// Bootstrap over runs, bias-corrected and accelerated (BCa; Efron 1987), with tails widened as
/// Student's t is wider than the normal (Hesterberg 2015), so that it holds from ten runs on. Of
/// more than 20,000 runs it is Student's interval, which is the same by then. NaN if a value is not
/// finite or there are fewer than two.
Interval bootstrap_mean(std::span<const double> values, double level);

/// The same for several columns {run} of equal length, which share their draws.
std::vector<Interval> bootstrap_means(std::span<const std::vector<double>> columns, double level);

}  // namespace montecarta::analysis
