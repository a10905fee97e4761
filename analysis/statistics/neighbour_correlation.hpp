// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// How a number of every scan goes together with that of the next scan, over runs: what a band over
/// a whole run depends on. Memory depends on the scans alone.
class NeighbourCorrelation {
 public:
  explicit NeighbourCorrelation(std::size_t scans) : pairs_(scans < 2 ? 0 : scans - 1) {}

  /// One run, {scan}; values above `cap` count as `cap`, so that a run that went astray does not
  /// speak for all. Pairs with a NaN are left out.
  void add(std::span<const double> values, double cap);
  /// {scan - 1} in [0, 1): correlation over runs of each scan with the next, pooled over an eighth
  /// of all scans to either side. 0, which makes the widest band, where nothing is known.
  std::vector<double> result() const;

 private:
  struct Pair {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  };
  std::vector<Pair> pairs_;
};

}  // namespace montecarta::analysis
