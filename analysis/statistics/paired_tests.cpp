// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/paired_tests.hpp"

#include <boost/math/distributions/binomial.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace montecarta::analysis {
namespace {

/// Indices of `values` such that key(values[i]) does not decrease; equal values keep their order.
template <class Key>
std::vector<std::size_t> sorted_indices(std::span<const double> values, Key key) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return key(values[i]); });
  return order;
}

/// Adds the ranks to `test`. Returns the sum of t^3 - t over groups of t equal sizes, by which ties
/// reduce the variance of the rank sum.
double add_ranks(std::span<const double> differences, SignedRank& test) {
  const auto size = [](double value) { return std::abs(value); };
  const auto order = sorted_indices(differences, size);
  double ties = 0.0;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && size(differences[order[last]]) == size(differences[order[first]]))
      ++last;
    const double rank = 0.5 * static_cast<double>(first + 1 + last);
    for (std::size_t k = first; k < last; ++k) {
      (differences[order[k]] > 0.0 ? test.positive : test.negative) += rank;
    }
    const auto t = static_cast<double>(last - first);
    ties += t * t * t - t;
  }
  return ties;
}

/// Share of the 2^n assignments of signs to the ranks 1 ... n with a sum of positive ranks of at
/// most `sum`.
double share_up_to(std::size_t n, double sum) {
  // {sum} number of assignments; exact, since it is below 2^50.
  std::vector<double> ways(n * (n + 1) / 2 + 1);
  ways[0] = 1.0;
  for (std::size_t rank = 1; rank <= n; ++rank) {
    for (std::size_t s = ways.size() - 1; s >= rank; --s) ways[s] += ways[s - rank];
  }
  const auto last = ways.begin() + static_cast<std::ptrdiff_t>(sum) + 1;
  return std::ldexp(std::accumulate(ways.begin(), last, 0.0), -static_cast<int>(n));
}

double normal_p(const SignedRank& test, double ties) {
  const auto n = static_cast<double>(test.n);
  const double expected = n * (n + 1.0) / 4.0;
  const double variance = (n * (n + 1.0) * (2.0 * n + 1.0) - 0.5 * ties) / 24.0;
  const double least = std::min(test.positive, test.negative);
  return std::erfc((expected - least) / std::sqrt(2.0 * variance));
}

}  // namespace

double sign_test(std::size_t won, std::size_t lost) {
  if (won == lost) return 1.0;
  const boost::math::binomial fair(static_cast<double>(won + lost), 0.5);
  return std::min(1.0, 2.0 * boost::math::cdf(fair, static_cast<double>(std::min(won, lost))));
}

SignedRank signed_rank_test(std::span<const double> differences) {
  std::vector<double> moved;
  std::ranges::copy_if(differences, std::back_inserter(moved), [](double d) { return d != 0.0; });
  SignedRank test;
  test.n = moved.size();
  if (test.n == 0) return test;
  const double ties = add_ranks(moved, test);
  test.is_exact = ties == 0.0 && moved.size() == differences.size() && test.n <= kMostExactRanks;
  const double least = std::min(test.positive, test.negative);
  test.p = test.is_exact ? std::min(1.0, 2.0 * share_up_to(test.n, least)) : normal_p(test, ties);
  return test;
}

std::vector<double> holm(std::span<const double> p) {
  std::vector<double> adjusted(p.size());
  double greatest = 0.0;
  std::size_t left = p.size();
  for (const std::size_t i : sorted_indices(p, [](double value) { return value; })) {
    greatest = std::max(greatest, std::min(1.0, static_cast<double>(left--) * p[i]));
    adjusted[i] = greatest;
  }
  return adjusted;
}

}  // namespace montecarta::analysis
