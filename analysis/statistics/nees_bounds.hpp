// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Closed interval of a NEES average [1].
struct Interval {
  double lower = 0.0;
  double upper = 0.0;
  static constexpr auto members() { return std::tuple(&Interval::lower, &Interval::upper); }
};

/// One end of each: `&Interval::lower` or `&Interval::upper`.
std::vector<double> ends_of(const std::vector<Interval>& intervals, double Interval::*end);

/// Interval that holds, with probability `level`, the average NEES of a consistent filter over
/// `runs` independent runs of an error of `dimension` components: (runs x average) is chi-square
/// with (runs x dimension) degrees of freedom, and both tails are equal (STATISTICS 3). Throws
/// StudyError if runs or dimension is 0 or level is not inside (0, 1).
Interval nees_bounds(std::uint64_t runs, std::uint64_t dimension, double level);

/// A test that a quoted interval may belong to.
struct IntervalMatch {
  std::uint64_t runs = 0;
  std::uint64_t dimension = 0;
  double level = 0.0;
  Interval exact;       ///< the interval of that test
  double digits = 0.0;  ///< larger distance of an end, in halves of the last digit quoted

  /// Returns whether the exact ends round to the digits that were quoted.
  bool within_digits() const { return digits <= 1.0; }
};

/// Which (runs, dimension, level) an interval quoted as [lower, upper] belongs to, best first, at
/// most `most` of them. Levels 80, 90, 95, 98, 99 and 99.9 % are tried, runs up to 100,000. An end
/// counts by its digits: 1.3 stands for anything from 1.25 to 1.35. Throws StudyError where not
/// 0 <= lower < upper.
std::vector<IntervalMatch> match_interval(double lower, double upper, std::size_t most = 5);

}  // namespace montecarta::analysis
