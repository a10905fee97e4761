// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/judgement.hpp"

#include <cstdint>
#include <functional>

namespace montecarta::analysis {

/// The NEES test of a planned study (STATISTICS 17).
struct NeesTest {
  std::uint64_t dimension = 3;  ///< number of components of the error
  double level = kUsualLevel;   ///< probability that a consistent filter is not rejected
  /// Number of independent scans in a run; 1 if errors never change within a run.
  std::uint64_t scans = 1;
};

/// Power of a study with a given number of runs, for a filter whose squared errors are off by the
/// same factor at all scans and in all components. found() and shown() are lower bounds.
class NeesPlan {
 public:
  /// Throws StudyError where `test` has no meaning, or has more than kMostPlannedScans scans.
  explicit NeesPlan(const NeesTest& test);

  /// Probability that `runs` runs show the ratio to differ from 1, on the side on which it does.
  double found(double ratio, std::uint64_t runs) const;
  /// Probability that `runs` runs show a consistent filter to be consistent within `within`.
  double shown(double within, std::uint64_t runs) const;
  /// The fewest runs for which found() or shown() is at least `power`. Throws StudyError where the
  /// question has no meaning, or if more than kMostPlannedRuns are needed.
  std::uint64_t runs_to_find(double ratio, double power) const;
  std::uint64_t runs_to_show(double within, double power) const;

 private:
  std::uint64_t fewest(const std::function<bool(std::uint64_t)>& is_enough) const;

  NeesTest test_;
};

inline constexpr std::uint64_t kMostPlannedScans = 100'000;

inline constexpr std::uint64_t kMostPlannedRuns = 1'000'000'000;

}  // namespace montecarta::analysis
