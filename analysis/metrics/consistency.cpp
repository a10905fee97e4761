// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/consistency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace montecarta {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Mean of the values that are numbers, in index order; NaN where there is none.
double mean_of_numbers(const std::vector<double>& values) {
  double sum = 0.0;
  std::size_t n = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++n;
  }
  return n == 0 ? kNaN : sum / static_cast<double>(n);
}

/// Twice as often outside as chance has it is still called consistent: neighbouring scans are
/// correlated, so the share scatters more than independent scans would.
Verdict verdict(const Consistency& consistency, double level) {
  if (std::isnan(consistency.share_inside)) return Verdict::untested;
  if (consistency.lasting_exit) return Verdict::inconsistent;
  if (1.0 - consistency.share_inside <= 2.0 * (1.0 - level)) return Verdict::consistent;
  return consistency.share_above >= consistency.share_below ? Verdict::optimistic
                                                            : Verdict::conservative;
}

}  // namespace

std::optional<std::size_t> first_lasting(const std::vector<bool>& above, std::size_t length) {
  std::size_t in_a_row = 0;
  for (std::size_t s = 0; s < above.size(); ++s) {
    in_a_row = above[s] ? in_a_row + 1 : 0;
    if (in_a_row == length) return s + 1 - length;
  }
  return std::nullopt;
}

Consistency judge(const NeesSeries& series, std::span<const double> times, double level) {
  std::vector<bool> above(series.average.size());
  std::size_t tested = 0, n_above = 0, n_below = 0;
  for (std::size_t s = 0; s < series.average.size(); ++s) {
    if (std::isnan(series.average[s])) continue;
    ++tested;
    above[s] = series.average[s] > series.bounds[s].upper;
    n_above += above[s] ? 1 : 0;
    n_below += series.average[s] < series.bounds[s].lower ? 1 : 0;
  }
  Consistency result;
  const auto share = [&](std::size_t n) {
    return tested == 0 ? kNaN : static_cast<double>(n) / static_cast<double>(tested);
  };
  result.mean = mean_of_numbers(series.average);
  result.median = mean_of_numbers(series.median);
  result.share_above = share(n_above);
  result.share_below = share(n_below);
  result.share_inside = share(tested - n_above - n_below);
  if (const auto exit = first_lasting(above, kLastingScans)) result.lasting_exit = times[*exit];
  result.verdict = verdict(result, level);
  return result;
}

std::string in_words(const Consistency& consistency) {
  switch (consistency.verdict) {
    case Verdict::untested:
      return "not tested";
    case Verdict::consistent:
      return "consistent";
    case Verdict::optimistic:
      return "optimistic";
    case Verdict::conservative:
      return "conservative";
    case Verdict::inconsistent:
      break;
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "inconsistent from %.1f s", *consistency.lasting_exit);
  return text.data();
}

}  // namespace montecarta
