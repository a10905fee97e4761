// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/median_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace montecarta {
namespace {

// Exponent and first four bits of the fraction of a double number the bins of all positive doubles
// in increasing order.
constexpr int kFractionBits = 4;
constexpr int kShift = 52 - kFractionBits;
constexpr int kLeastExponent = -12;
constexpr int kMostExponent = 32;
constexpr std::size_t kBins = std::size_t{kMostExponent - kLeastExponent} << kFractionBits;

std::size_t bin_of(double value) {
  const double least = std::ldexp(1.0, kLeastExponent);
  const double most = std::nextafter(std::ldexp(1.0, kMostExponent), 0.0);
  const auto number = [](double v) { return std::bit_cast<std::uint64_t>(v) >> kShift; };
  return static_cast<std::size_t>(number(std::clamp(value, least, most)) - number(least));
}

double lower_edge(std::size_t bin) {
  const double octave = std::ldexp(1.0, kLeastExponent + static_cast<int>(bin >> kFractionBits));
  const double part = static_cast<double>(bin & ((1u << kFractionBits) - 1));
  return octave * (1.0 + part / (1 << kFractionBits));
}

}  // namespace

MedianTable::MedianTable(std::size_t scans) : counts_(scans * kBins) {}

void MedianTable::add(std::size_t scan, double value) { ++counts_[scan * kBins + bin_of(value)]; }

double MedianTable::median(std::size_t scan) const {
  const std::span bins = std::span(counts_).subspan(scan * kBins, kBins);
  const double half = 0.5 * static_cast<double>(std::accumulate(bins.begin(), bins.end(), 0ull));
  double below = 0.0;
  for (std::size_t b = 0; b < kBins; ++b) {
    const double here = bins[b];
    if (here > 0.0 && below + here >= half) {
      const double part = (half - below) / here;
      return lower_edge(b) + part * (lower_edge(b + 1) - lower_edge(b));
    }
    below += here;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace montecarta
