// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Averages of a NEES over runs that are drawn again and again: every run counts in every replicate
/// as often as a Poisson variable of mean 1 says (Hanley and MacGibbon 2006), so that runs need not
/// be kept. The draws depend on the place of the run alone.
class ExitBootstrap {
 public:
  explicit ExitBootstrap(std::size_t scans);

  /// The next run, {scan}; NaN where undefined.
  void add(std::span<const double> nees);
  /// {replicate} [s] when its average leaves the band of `level` upwards for good, infinity where
  /// never; `times` [s] of the scans.
  std::vector<double> lasting_exits(std::span<const double> times, std::size_t dimension,
                                    double level);

 private:
  using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  void flush();
  /// Upper end of the band of the average over so many runs.
  using UpperEnd = std::function<double(std::uint64_t runs)>;
  double lasting_exit(Eigen::Index replicate, std::span<const double> times,
                      const UpperEnd& upper_end) const;

  Matrix sums_;       ///< {replicate, scan}
  Matrix weights_;    ///< {replicate, scan} that went into them
  Matrix batch_;      ///< {run, scan} waiting
  Matrix is_number_;  ///< {run, scan} 1 or 0
  Matrix counts_;     ///< {replicate, run} of those that wait
  Eigen::Index waiting_ = 0;
  std::uint64_t runs_ = 0;
};

/// Where a share `level` of `values` lies, both tails equal; infinity is a value like others.
Interval middle_of(std::vector<double> values, double level);

}  // namespace montecarta::analysis
