// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Fewer values than this say nothing of a distribution.
inline constexpr std::size_t kLeastValues = 40;

/// What the histogram of a probability integral transform says of a filter.
enum class Calibration {
  untested,    ///< fewer than kLeastValues
  calibrated,  ///< every bin within the band
  too_narrow,  ///< too many values at both ends: the truth is farther off than the filter says
  too_wide,    ///< too many values in the middle
  shifted      ///< more on one side: the filter is off in one direction
};

/// Counts that every bin of a histogram keeps at once with probability `joint`, if all values are
/// independent and uniform.
struct CountBand {
  std::size_t lower = 0;
  std::size_t upper = 0;
  double joint = 0.0;
};

/// The narrowest band, with equal tails of a bin's binomial, that `bins` counts of `values` in all
/// keep together with probability `level` at least. Exact: the multinomial is that of Poisson
/// counts given their sum, so its probability is a convolution.
CountBand joint_band(std::size_t values, std::size_t bins, double level);

/// Values in (0, 1) against the uniform distribution.
struct Uniformity {
  std::vector<std::size_t> counts;  ///< {bin}
  CountBand band;
  double mean = 0.0;      ///< of the values; 1/2 if uniform
  double variance = 0.0;  ///< about 1/2; 1/12 if uniform
  Calibration verdict = Calibration::untested;
};

/// Bins for so many values: ten, fewer of less than 100.
std::size_t bins_for(std::size_t values);

/// The band of so many values in their bins; without meaning below kLeastValues.
CountBand band_for(std::size_t values, double level);

/// Judges values by the band of their number, band_for(), which takes longer to find: every bin
/// within it is calibrated; else the moment that is farther from what it should be, in standard
/// errors, names what is wrong.
Uniformity judge_uniformity(std::span<const double> values, const CountBand& band);

std::string in_words(Calibration verdict);

}  // namespace montecarta::analysis
