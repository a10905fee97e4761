// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/statistics/correlation.hpp"
#include "analysis/statistics/whole_run_band.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
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

/// Adds up the NEES of one block by one definition over runs. Memory depends on the scans, and
/// grows by one number with every run.
class NeesAccumulator {
 public:
  /// `dimension`: components of the block; 0: those of a pose in the plane.
  NeesAccumulator(ErrorBlock block, Moments moments, std::size_t scans, std::size_t dimension = 0);
  Moments moments() const { return moments_; }
  void add(const RunMetrics& metrics);
  /// The NEES {scan} of a run, NaN if it is unusable, with the `rank` {scan} of its covariances
  /// (empty: full) and `too_few` {scan}: 1 where too few draws were left to judge (empty: nowhere).
  void add(std::span<const double> value, std::span<const int> rank = {},
           std::span<const std::uint8_t> too_few = {});
  /// `times` [s] of the scans; `walks` of as many; `within` the margin of judge(). `look_level` is
  /// that of the verdict where it is taken at several looks; `level` where it is not given.
  NeesResult result(std::span<const double> times, double level, const BandWalks& walks,
                    double within = kUsualMargin,
                    std::optional<double> look_level = std::nullopt) const;

 private:
  NeesSeries series(double level, double verdict_level, const BandWalks& walks) const;

  ErrorBlock block_;
  Moments moments_;
  std::size_t dimension_;
  std::vector<double> sum_;          ///< {scan} of finite NEES
  std::vector<std::uint32_t> runs_;  ///< {scan} in the sum
  QuantileTable table_;
  NeighbourCorrelation neighbours_;
  std::vector<double> run_averages_;  ///< {run that has any}
  std::uint64_t samples_ = 0, lower_rank_ = 0, unusable_ = 0, too_few_ = 0, unjudged_runs_ = 0;
};

}  // namespace montecarta::analysis
