// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Number of replicates of a bootstrap over `runs`: 2000, and fewer for so many runs that
/// replicates hardly differ.
std::size_t bootstrap_replicates(std::size_t runs);

/// Fills `drawn` with the `runs` indices that replicate `b` draws with replacement: the same in
/// every call.
void draw_runs(std::size_t runs, std::size_t b, std::vector<std::uint32_t>& drawn);

/// Interval at `level` for the mean over infinitely many runs, given one value for each run: a
/// bootstrap over runs, bias-corrected and accelerated (BCa; Efron 1987). Its tails are widened as
/// much as Student's t is wider than the normal law (Hesterberg 2015), so that it holds from ten
/// runs on. For more than 20,000 runs it is Student's interval, which is then the same. NaN if a
/// value is not finite or there are fewer than two values.
Interval bootstrap_mean(std::span<const double> values, double level);

/// Intervals of bootstrap_mean() for several columns {run} of equal length, which share their
/// draws.
std::vector<Interval> bootstrap_means(std::span<const std::vector<double>> columns, double level);

}  // namespace montecarta::analysis
