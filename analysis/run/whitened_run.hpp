// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace montecarta::analysis {

/// Errors in units of their deviation are cut to this one.
inline constexpr double kLargestError = 1e30;

/// Errors of one run in units of the covariance that its filter reported.
struct WhitenedRun {
  std::size_t dimension = 0;
  /// {scan, component} L^-1 e, where the covariance is L L'; NaN where it is singular.
  std::vector<double> whitened;
  /// {scan, component} Each component divided by its own deviation; NaN where this is 0.
  std::vector<double> standardised;
  /// {component} The largest error where the reported deviation is 0; 0 if there is none.
  std::vector<double> errors_of_exact = {};
  std::uint64_t number = 0;  ///< of the run
};

}  // namespace montecarta::analysis
