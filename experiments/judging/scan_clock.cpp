// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/scan_clock.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace montecarta::experiments {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// A run that lacks a smaller part of the drive at its end did not fail.
constexpr double kLeastMissed = 0.05;

std::vector<double> spacings(std::span<const double> times) {
  std::vector<double> found(times.size());
  std::adjacent_difference(times.begin(), times.end(), found.begin());
  if (!found.empty()) found.erase(found.begin());
  return found;
}

const std::vector<double>& longest_of(const TimesOfRuns& runs) {
  return *std::ranges::max_element(runs, {}, [](const auto& times) { return times.size(); });
}

}  // namespace

ScanClock::ScanClock(std::span<const TimesOfRuns> cells, double tolerance) {
  std::vector<double> all;
  for (const TimesOfRuns& runs : cells) {
    for (const std::vector<double>& times : runs) all.insert(all.end(), times.begin(), times.end());
  }
  std::ranges::sort(all);
  for (const double time : all) {
    if (first_.empty() || time > first_.back() + 2.0 * tolerance) first_.push_back(time);
  }
  const std::vector<double>* longest = &longest_of(cells.front());
  for (const TimesOfRuns& runs : cells) {
    is_common_ = is_common_ && are_in_step(runs);
    const std::vector<double>& of_cell = longest_of(runs);
    if (of_cell.size() > longest->size()) longest = &of_cell;
    OfCell& cell = cells_.emplace_back(OfCell{kEndless, -kEndless, usual_spacing(of_cell)});
    for (const std::vector<double>& times : runs) {
      if (times.empty()) continue;
      cell.begin = std::min(cell.begin, times.front());
      cell.end = std::max(cell.end, times.back());
    }
  }
  if (!is_common_) first_.clear();
  times_ = is_common_ ? first_ : *longest;
  if (!is_common_) return;
  const std::vector<std::size_t> scans = scans_of(*longest);
  for (std::size_t row = 0; row < longest->size(); ++row) times_[scans[row]] = (*longest)[row];
}

/// Whether at least half of the runs have at least half of their times in common with another run.
bool ScanClock::are_in_step(const TimesOfRuns& runs) const {
  std::vector<std::size_t> met(first_.size());
  for (const std::vector<double>& times : runs) {
    for (const std::size_t scan : scans_of(times)) ++met[scan];
  }
  std::size_t with_rows = 0, in_step = 0;
  for (const std::vector<double>& times : runs) {
    if (times.empty()) continue;
    ++with_rows;
    const std::vector<std::size_t> scans = scans_of(times);
    const auto shared = std::ranges::count_if(scans, [&](std::size_t s) { return met[s] > 1; });
    if (2 * static_cast<std::size_t>(shared) >= times.size()) ++in_step;
  }
  return with_rows < 2 || 2 * in_step >= with_rows;
}

std::optional<double> ScanClock::missed_after(double last, std::size_t cell) const {
  const OfCell& of = cells_[cell];
  const double wanted = last + std::max(0.9 * of.period, kLeastMissed * (of.end - of.begin));
  if (!is_common_ || of.end < wanted) return std::nullopt;
  return wanted;
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
