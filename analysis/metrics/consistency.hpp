// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/nees_bounds.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta {

/// The average NEES leaves its band for good when it stays above the upper bound for so many
/// consecutive scans (5 s at 5 Hz); a single scan above it means nothing (SPEC 19).
inline constexpr std::size_t kLastingScans = 25;

/// NEES of one definition of error and covariance over scans and runs.
struct NeesSeries {
  std::size_t dimension = 0;
  std::vector<double> average;      ///< {scan} over valid runs; NaN where there is none
  std::vector<double> median;       ///< {scan} over valid runs, to 3 %
  std::vector<std::uint32_t> runs;  ///< {scan} valid: complete, with a finite NEES
  std::vector<Interval> bounds;     ///< {scan} of the average, from `runs`
  std::uint64_t samples = 0;        ///< scans x complete runs
  std::uint64_t floored = 0;        ///< of them: singular covariance, floor added (SPEC 19)
  std::uint64_t undefined = 0;      ///< of them: not a number, left out of average and median
};

enum class Verdict {
  untested,      ///< no covariance stored, or no complete run
  consistent,    ///< outside the band at most twice as often as chance has it
  inconsistent,  ///< leaves the band upwards for good
  optimistic,    ///< outside too often, mostly above: errors larger than the filter says
  conservative,  ///< outside too often, mostly below: errors smaller than the filter says
};

/// What a NeesSeries says in a few numbers.
struct Consistency {
  Verdict verdict = Verdict::untested;
  double mean = 0.0;          ///< of the averages, over scans
  double median = 0.0;        ///< of the medians, over scans
  double share_inside = 0.0;  ///< of scans with a valid run; the three add up to 1
  double share_above = 0.0;
  double share_below = 0.0;
  std::optional<double> lasting_exit;  ///< [s] first scan of the first kLastingScans above in a row
};

/// Index at which the first `length` consecutive true values begin; nullopt = never.
std::optional<std::size_t> first_lasting(const std::vector<bool>& above, std::size_t length);

/// Judges a series at `level`; `times` [s] of its scans.
Consistency judge(const NeesSeries& series, std::span<const double> times, double level);

/// The verdict as one reads it: "consistent", "inconsistent from 4.2 s", ...
std::string in_words(const Consistency& consistency);

}  // namespace montecarta
