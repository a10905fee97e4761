// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/quantile_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

namespace montecarta::analysis {
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

/// Where a share `part` of a bin lies below.
double within(std::size_t bin, double part) {
  return std::lerp(lower_edge(bin), lower_edge(bin + 1), part);
}

double count_of(std::span<const std::uint32_t> bins) {
  return static_cast<double>(std::accumulate(bins.begin(), bins.end(), std::uint64_t{0}));
}

}  // namespace

QuantileTable::QuantileTable(std::size_t scans) : counts_(scans * kBins) {}

void QuantileTable::add(std::size_t scan, double value) { ++counts_[scan * kBins + bin_of(value)]; }

std::span<const std::uint32_t> QuantileTable::bins_of(std::size_t scan) const {
  return std::span(counts_).subspan(scan * kBins, kBins);
}

double QuantileTable::median(std::size_t scan) const {
  const auto bins = bins_of(scan);
  const double half = 0.5 * count_of(bins);
  double below = 0.0;
  for (std::size_t b = 0; b < kBins; ++b) {
    const double here = bins[b];
    if (here > 0.0 && below + here >= half) return within(b, (half - below) / here);
    below += here;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double QuantileTable::trimmed_mean(std::size_t scan, double trim) const {
  const auto bins = bins_of(scan);
  const double first = trim * count_of(bins), last = (1.0 - trim) * count_of(bins);
  double below = 0.0, sum = 0.0;
  for (std::size_t b = 0; b < kBins && below < last; ++b) {
    const double here = bins[b];
    const double from = std::max(below, first), to = std::min(below + here, last);
    below += here;
    if (to <= from) continue;
    sum += (to - from) * within(b, (0.5 * (from + to) - (below - here)) / here);
  }
  return sum / (last - first);
}

}  // namespace montecarta::analysis
