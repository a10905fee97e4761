// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/named_rows.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Series over one common time, short enough to draw.
struct ThinnedSeries {
  std::vector<double> times;  ///< [s]
  std::vector<NamedSeries> series;
};

/// Leaves at most 2 x `buckets` values of each series: the least and the greatest of every stretch
/// of time, in the order in which they occur, so no peak is lost. Times are those of the stretch's
/// beginning and middle. A stretch without a number stays NaN. Short series come back as they are.
ThinnedSeries thin(std::span<const double> times, const std::vector<NamedSeries>& series,
                   std::size_t buckets);

}  // namespace montecarta::analysis
