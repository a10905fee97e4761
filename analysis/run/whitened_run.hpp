// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace montecarta::analysis {

/// The largest error in units of its deviation: larger ones are cut to it.
inline constexpr double kLargestError = 1e30;

/// Errors of one run in units of the covariance that its filter reported.
struct WhitenedRun {
  std::size_t dimension = 0;
  /// {scan, component} L^-1 e, where the covariance is L L'; NaN where it is singular.
  std::vector<double> whitened;
  /// {scan, component} error of each component divided by its own deviation; NaN where this is 0.
  std::vector<double> standardised;
  /// {component} largest error among those with a reported deviation of 0; 0 if there is none.
  std::vector<double> errors_of_exact = {};
  std::uint64_t number = 0;  ///< number of the run in the study
};

}  // namespace montecarta::analysis
