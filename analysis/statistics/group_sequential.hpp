// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace montecarta::analysis {

/// Probability that a normal statistic that is looked at `looks` times, each time after twice as
/// many runs as before, is at some look farther from 0 than what it exceeds at a single look with
/// probability `single` (two-sided).
double crossing_probability(std::uint64_t looks, double single);

/// The level of each of `looks` looks, so that the verdicts at all of them reject a consistent
/// filter with a probability of 1 - level at most: the same at every look (Pocock), with looks
/// after 1, 2, 4, ... times as many runs. `level` itself where there is one look. The average over
/// the run counts by its correlation between looks, the band for all scans by Bonferroni.
double level_of_a_look(double level, std::uint64_t looks);

}  // namespace montecarta::analysis
