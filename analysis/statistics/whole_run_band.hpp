// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// False rejections by the band for one by the average.
inline constexpr double kBandShare = 0.25;

/// A test in two parts that together reject a consistent filter with the probability that the level
/// leaves, the average over the run four times as often as the band.
struct WholeRunTest {
  double deviate = 0.0;          ///< of the band: the process stays within so many deviations
  double average_deviate = 0.0;  ///< of the average over the run, in estimated deviations
  double average_level = 0.0;    ///< of the average over the run alone
  double average_skew = 1.0;     ///< skewness of a run's average in that of a gamma of its variance
};

/// Walks of a Gaussian process, drawn once for all bands of a study: 4000 of them, fewer where runs
/// are so long that memory would suffer (64 MB).
class BandWalks {
 public:
  explicit BandWalks(std::size_t scans);

  /// For a process of variance 1 with `correlation` {scan - 1} in [0, 1) of each scan with the
  /// next, a Markov chain (first-order autoregression). What goes together for longer than that
  /// leaves a band less often, so the band errs to the wide side. The deviation of the average is
  /// estimated from `runs` (taken as three where there are fewer), but at most that of one scan, a
  /// chi-square of `dimension` degrees of freedom.
  WholeRunTest test(std::span<const double> correlation, std::size_t runs, std::size_t dimension,
                    double level) const;

 private:
  /// How far a walk gets from 0, and its average.
  struct Reach {
    double greatest, average;
  };
  Reach reach(std::size_t walk, std::span<const double> correlation,
              std::span<const double> rest) const;

  std::size_t scans_;
  std::vector<float> normals_;       ///< {walk, scan}
  std::vector<double> of_variance_;  ///< {walk} standard normal
};

}  // namespace montecarta::analysis
