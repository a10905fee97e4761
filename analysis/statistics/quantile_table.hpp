// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Medians and trimmed means over runs of a positive number at every scan, to 3 %, in memory that
/// does not grow with the number of runs: one histogram a scan, sixteen bins an octave from 2^-12
/// to 2^32. Counts commute, so the order of runs does not matter.
class QuantileTable {
 public:
  explicit QuantileTable(std::size_t scans);

  /// `value` >= 0, not NaN.
  void add(std::size_t scan, double value);
  /// NaN where nothing was added.
  double median(std::size_t scan) const;
  /// Mean without a share `trim` < 0.5 at either end; NaN where nothing was added.
  double trimmed_mean(std::size_t scan, double trim) const;

 private:
  std::span<const std::uint32_t> bins_of(std::size_t scan) const;

  std::vector<std::uint32_t> counts_;  ///< {scan, bin}
};

}  // namespace montecarta::analysis
