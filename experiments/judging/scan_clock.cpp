// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/scan_clock.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace montecarta::experiments {
namespace {

/// Files share their times if these make at most this many times the scans of the longest file.
constexpr double kMostScans = 1.5;

std::vector<double> spacings(std::span<const double> times) {
  std::vector<double> found(times.size());
  std::adjacent_difference(times.begin(), times.end(), found.begin());
  if (!found.empty()) found.erase(found.begin());
  return found;
}

}  // namespace

ScanClock::ScanClock(std::span<const std::vector<double>> files, double tolerance) {
  std::vector<double> all;
  for (const std::vector<double>& times : files) all.insert(all.end(), times.begin(), times.end());
  std::ranges::sort(all);
  for (const double time : all) {
    if (first_.empty() || time > first_.back() + 2.0 * tolerance) first_.push_back(time);
  }
  const std::vector<double>& longest =
      *std::ranges::max_element(files, {}, [](const auto& times) { return times.size(); });
  is_common_ =
      static_cast<double>(first_.size()) <= kMostScans * static_cast<double>(longest.size());
  period_ = usual_spacing(longest);
  if (!is_common_) first_.clear();
  times_ = is_common_ ? first_ : longest;
  if (!is_common_) return;
  const std::vector<std::size_t> scans = scans_of(longest);
  for (std::size_t row = 0; row < longest.size(); ++row) times_[scans[row]] = longest[row];
}

std::vector<std::size_t> ScanClock::scans_of(std::span<const double> times) const {
  std::vector<std::size_t> scans(times.size());
  std::iota(scans.begin(), scans.end(), std::size_t{0});
  if (!is_common_) return scans;
  for (std::size_t row = 0; row < times.size(); ++row) {
    const auto after = std::ranges::upper_bound(first_, times[row]);
    scans[row] = static_cast<std::size_t>(after - first_.begin()) - 1;
  }
  return scans;
}

double least_spacing(std::span<const double> times) {
  const std::vector<double> found = spacings(times);
  return found.empty() ? std::numeric_limits<double>::infinity() : *std::ranges::min_element(found);
}

double usual_spacing(std::span<const double> times) {
  std::vector<double> found = spacings(times);
  if (found.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
  std::ranges::nth_element(found, middle);
  return *middle;
}

}  // namespace montecarta::experiments
