// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::experiments {

/// {run}{row} Times [s] of the estimates of one estimator, increasing in each run.
using TimesOfRuns = std::vector<std::vector<double>>;

/// The scans of a study of imported estimates, and the scan to which each row of a run belongs.
class ScanClock {
 public:
  /// Takes the times of all estimators {cell}. Times within `tolerance` [s] of each other are one
  /// scan, and the scans are all times that occur. But if most runs of an estimator have times that
  /// no other run of it has, runs have clocks of their own, and row k of each is scan k.
  ScanClock(std::span<const TimesOfRuns> cells, double tolerance);

  /// {scan} Times [s]; where the file with the most rows has the scan, its own.
  const std::vector<double>& times() const { return times_; }
  /// Whether the runs share their times.
  bool is_common() const { return is_common_; }
  /// {row} The scans of rows with these times, increasing.
  std::vector<std::size_t> scans_of(std::span<const double> times) const;
  /// The time [s] at which a run of an estimator would have further rows if it ended at `last`
  /// before other runs; nullopt if it ends with them, or if runs have clocks of their own.
  std::optional<double> missed_after(double last, std::size_t cell) const;

 private:
  struct OfCell {
    double begin = 0.0, end = 0.0;  ///< [s] first and last time of any run
    double period = 0.0;            ///< [s] usual time between two rows of its longest run
  };

  bool are_in_step(const TimesOfRuns& runs) const;

  std::vector<double> first_;  ///< {scan} earliest time of the scan; empty without common times
  std::vector<double> times_;
  std::vector<OfCell> cells_;
  bool is_common_ = true;
};

/// The smallest difference of two neighbouring times; infinite for fewer than two.
double least_spacing(std::span<const double> times);
/// The median difference of neighbouring times; infinite for fewer than two.
double usual_spacing(std::span<const double> times);

}  // namespace montecarta::experiments
