// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"

#include <cstdint>

namespace montecarta::analysis {

/// Interval that holds, with probability `level`, the average NEES of a consistent filter over
/// `runs` independent runs of an error of `dimension` components: (runs x average) is chi-square
/// with (runs x dimension) degrees of freedom, and both tails are equal (STATISTICS 3). Throws
/// StudyError if runs or dimension is 0 or level is not inside (0, 1).
Interval nees_bounds(std::uint64_t runs, std::uint64_t dimension, double level);

}  // namespace montecarta::analysis
