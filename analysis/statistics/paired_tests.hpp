// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Two-sided p-value of the exact sign test: the probability that a fair coin falls at least as
/// unevenly as `won` to `lost`. Ties count for neither. 1 if `won` equals `lost`.
double sign_test(std::size_t won, std::size_t lost);

/// Result of Wilcoxon's signed-rank test of whether paired differences are symmetric about zero.
struct SignedRank {
  double p = 1.0;         ///< two-sided p-value
  std::size_t n = 0;      ///< number of differences that are not zero; the others are left out
  double positive = 0.0;  ///< sum of the ranks, by size from 1, of differences above zero
  /// Sum of the ranks of differences below zero; ties share the mean of their ranks.
  double negative = 0.0;
  /// Whether p is exact; else it is from the normal law, corrected for ties.
  bool is_exact = false;
};

/// Tests `differences`, which are finite. The p-value is exact for at most kMostExactRanks
/// differences without ties and zeros.
SignedRank signed_rank_test(std::span<const double> differences);
inline constexpr std::size_t kMostExactRanks = 50;

/// Adjusted p-values of a family of tests (Holm 1979), in the order of `p`. If those below 1 -
/// level are called significant, one call or more is false with a probability of at most 1 - level.
std::vector<double> holm(std::span<const double> p);

}  // namespace montecarta::analysis
