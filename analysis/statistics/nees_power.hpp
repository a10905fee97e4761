// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace montecarta::analysis {

/// A question about the two-sided test of an average NEES (nees_bounds.hpp): how surely does it
/// find a filter whose NEES is `ratio` times what it should be?
struct NeesTest {
  std::uint64_t dimension = 3;  ///< of the error
  double ratio = 1.5;           ///< [1] above 1: overconfident; below 1: conservative
  double level = 0.95;          ///< probability that a consistent filter passes, all scans together
  std::uint64_t scans = 1;      ///< independent scans, at all of which the NEES is off
};

/// Level of each scan's test such that all of `scans` independent ones pass with probability
/// `level` if the filter is consistent (Sidak): level^(1 / scans).
double level_of_one_scan(double level, std::uint64_t scans);

/// Probability that `runs` runs find it: that the average leaves the interval at one scan or more,
/// on the side on which the NEES is off. (runs x average / ratio) is chi-square with (runs x
/// dimension) degrees of freedom. Throws StudyError where the question has no meaning.
double nees_power(const NeesTest& test, std::uint64_t runs);

/// The fewest runs that find it with probability `power`. Throws StudyError where the question has
/// no meaning, or needs more than kMostPlannedRuns.
std::uint64_t runs_needed(const NeesTest& test, double power);
inline constexpr std::uint64_t kMostPlannedRuns = 1'000'000'000;

}  // namespace montecarta::analysis
