// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/lineages.hpp"

#include <array>
#include <cstddef>
#include <limits>

namespace montecarta::analysis {

/// Ancestries over runs (Lineages).
struct LineageSummary {
  std::array<double, kLineageLags.size()> ancestors{};  ///< {lag} mean over runs; NaN: too short
  double coalescence = 0.0;      ///< [s] mean over the runs that have a common ancestor
  double coalesced_share = 0.0;  ///< of the scans looked at
  /// Of the mean squared position error that is due to few particles; NaN where particles are not
  /// stored.
  double monte_carlo_share = std::numeric_limits<double>::quiet_NaN();
};

/// Adds up Lineages over runs; what a run does not have is not averaged.
class LineageSums {
 public:
  void add(const Lineages& lineages);
  bool empty() const { return runs_ == 0; }
  LineageSummary result() const;

 private:
  struct Mean {
    double sum = 0.0, n = 0.0;
    void add(double value);
    double value() const { return sum / n; }
  };
  std::size_t runs_ = 0;
  std::array<Mean, kLineageLags.size()> ancestors_;
  Mean coalescence_, coalesced_, variance_, squared_error_;
};

}  // namespace montecarta::analysis
