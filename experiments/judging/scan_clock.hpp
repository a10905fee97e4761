// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::experiments {

/// The scans of a study of imported estimates, and the scan to which each row of a run belongs.
class ScanClock {
 public:
  /// Takes the times [s] {file}{row} of all files, increasing in each. Times within `tolerance` [s]
  /// of each other are one scan, and the scans are all times that occur. If that makes many more
  /// scans than any file has rows, runs have clocks of their own, and row k of each is scan k.
  ScanClock(std::span<const std::vector<double>> files, double tolerance);

  /// {scan} Times [s]; where the file with the most rows has the scan, its own.
  const std::vector<double>& times() const { return times_; }
  /// Usual time [s] between two scans of the longest file.
  double period() const { return period_; }
  /// Whether the files share their times.
  bool is_common() const { return is_common_; }
  /// {row} The scans of rows with these times, increasing.
  std::vector<std::size_t> scans_of(std::span<const double> times) const;

 private:
  std::vector<double> first_;  ///< {scan} earliest time of the scan; empty without common times
  std::vector<double> times_;
  double period_;
  bool is_common_ = true;
};

/// The smallest difference of two neighbouring times; infinite for fewer than two.
double least_spacing(std::span<const double> times);
/// The median difference of neighbouring times; infinite for fewer than two.
double usual_spacing(std::span<const double> times);

}  // namespace montecarta::experiments
