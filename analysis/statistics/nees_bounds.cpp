// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/nees_bounds.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

namespace montecarta::analysis {
namespace {

constexpr std::array kQuotedLevels = {0.80, 0.90, 0.95, 0.98, 0.99, 0.999};
constexpr std::uint64_t kMostRuns = 100'000;
constexpr std::uint64_t kMostDimensions = 1'000;

/// Half a unit in the last decimal place of the shortest text that gives `value`.
double half_digit(double value) {
  std::array<char, 400> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed).ptr;
  const std::string_view digits(text.data(), static_cast<std::size_t>(end - text.data()));
  const std::size_t point = digits.find('.');
  const std::size_t decimals = point == digits.npos ? 0 : digits.size() - point - 1;
  return 0.5 * std::pow(10.0, -static_cast<double>(decimals));
}

struct Quoted {
  Interval ends;
  Interval half_digits;
};

/// The fewest runs with an interval no wider than `width`; it narrows as runs grow.
std::uint64_t runs_of_width(double width, std::uint64_t dimension, double level) {
  std::uint64_t low = 1, high = kMostRuns;
  while (low < high) {
    const std::uint64_t middle = (low + high) / 2;
    const Interval interval = nees_bounds(middle, dimension, level);
    if (interval.upper - interval.lower <= width) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

void add_matches(const Quoted& quoted, std::uint64_t dimension, double level,
                 std::vector<IntervalMatch>& found) {
  const auto [lower, upper] = quoted.ends;
  const std::uint64_t near = runs_of_width(upper - lower, dimension, level);
  for (std::uint64_t runs = near > 3 ? near - 3 : 1; runs <= near + 2; ++runs) {
    const Interval exact = nees_bounds(runs, dimension, level);
    const double digits = std::max(std::abs(lower - exact.lower) / quoted.half_digits.lower,
                                   std::abs(upper - exact.upper) / quoted.half_digits.upper);
    found.push_back({runs, dimension, level, exact, digits});
  }
}

}  // namespace

std::vector<double> ends_of(const std::vector<Interval>& intervals, double Interval::*end) {
  std::vector<double> ends;
  for (const Interval& interval : intervals) ends.push_back(interval.*end);
  return ends;
}

Interval nees_bounds(std::uint64_t runs, std::uint64_t dimension, double level) {
  if (runs == 0 || dimension == 0) {
    throw StudyError("NEES bounds: runs = " + std::to_string(runs) +
                     ", dimension = " + std::to_string(dimension) +
                     " (an average needs at least one of each): give 1 or more");
  }
  if (!(level > 0.0 && level < 1.0)) {
    throw StudyError("NEES bounds: level = " + std::to_string(level) +
                     " (a probability strictly between 0 and 1): give for instance 0.95");
  }
  const double n = static_cast<double>(runs);
  const boost::math::chi_squared sum(n * static_cast<double>(dimension));
  const double tail = (1.0 - level) / 2.0;
  return {boost::math::quantile(sum, tail) / n,
          boost::math::quantile(boost::math::complement(sum, tail)) / n};
}

std::vector<IntervalMatch> match_interval(double lower, double upper, std::size_t most) {
  if (!(lower >= 0.0 && lower < upper && std::isfinite(upper))) {
    throw StudyError("interval [" + std::to_string(lower) + ", " + std::to_string(upper) +
                     "] (a NEES interval has 0 <= lower < upper): give the lower end first");
  }
  const Quoted quoted{{lower, upper}, {half_digit(lower), half_digit(upper)}};
  // The average of a consistent filter is the dimension, which lies inside every interval.
  const auto last =
      static_cast<std::uint64_t>(std::min(std::ceil(upper), static_cast<double>(kMostDimensions)));
  std::vector<IntervalMatch> found;
  for (auto dimension = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(lower));
       dimension <= last; ++dimension) {
    for (const double level : kQuotedLevels) add_matches(quoted, dimension, level, found);
  }
  std::ranges::stable_sort(found, {}, &IntervalMatch::digits);
  found.resize(std::min(most, found.size()));
  return found;
}

}  // namespace montecarta::analysis
