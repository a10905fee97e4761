// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/spread.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// A single run is lost when its NEES stays above its upper bound for so many consecutive scans
/// (5 s at 5 Hz); a single scan above it means nothing (STATISTICS 7).
inline constexpr std::size_t kLastingScans = 25;

/// Index at which the first `length` consecutive true values begin; nullopt if there are none.
std::optional<std::size_t> first_lasting(const std::vector<bool>& above, std::size_t length);

/// Share of the runs that are not lost yet: a run is lost when its own NEES stays above the band of
/// a single run for kLastingScans, or when it fails.
struct Survival {
  std::size_t runs = 0;            ///< complete and failed
  std::size_t lost = 0;            ///< of them: by the end
  std::vector<double> share;       ///< {scan} of the runs
  std::vector<Interval> interval;  ///< {scan} of the share (Wilson 1927)
  double median = kNaN;            ///< [s] when half of them are lost; infinity: never
  Interval median_interval = {};   ///< [s] of the median, by median_interval(); NaN of few runs
};

/// `ends` [s] of the runs, infinity where a run lasts; `times` [s] of the scans.
Survival survival_of(std::span<const double> ends, std::span<const double> times, double level);

}  // namespace montecarta::analysis
