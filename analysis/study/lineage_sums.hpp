// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/lineages.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/study/metric.hpp"

#include <array>
#include <cstddef>
#include <tuple>

namespace montecarta::analysis {

/// Means over runs of Lineages.
struct LineageSummary {
  /// {lag} mean over runs; NaN if all runs are too short.
  std::array<double, kLineageLags.size()> ancestors{};
  double coalescence = kNaN;  ///< [s] mean over the runs with a common ancestor
  /// Share of the followed scans at which all particles have one common ancestor.
  double coalesced_share = kNaN;
  /// Share of the mean squared position error that comes from the small number of particles; NaN if
  /// particles are not stored.
  double monte_carlo_share = kNaN;
};

/// Adds up Lineages over runs. Values that a run lacks are left out of the averages.
class LineageSums {
 public:
  void add(const Lineages& lineages);
  bool empty() const { return runs_ == 0; }
  LineageSummary result() const;
  static constexpr auto parts() {
    using Sums = LineageSums;
    return std::tuple(added(&Sums::runs_, &Sums::ancestors_, &Sums::coalescence_, &Sums::coalesced_,
                            &Sums::variance_, &Sums::squared_error_));
  }

 private:
  struct Mean {
    double sum = 0.0, n = 0.0;
    void add(double value);
    double value() const { return sum / n; }
    static constexpr auto parts() { return std::tuple(added(&Mean::sum, &Mean::n)); }
  };
  std::size_t runs_ = 0;
  std::array<Mean, kLineageLags.size()> ancestors_;
  Mean coalescence_, coalesced_, variance_, squared_error_;
};

/// Columns of files and of a table for the ancestries of a cell.
const std::vector<ResultNumber<LineageSummary>>& lineage_numbers();

}  // namespace montecarta::analysis
