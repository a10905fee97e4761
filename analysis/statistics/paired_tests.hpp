// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Two-sided p of the exact sign test: how probable it is that a fair coin falls as unevenly as
/// `won` to `lost`, or more so. Ties belong to neither. 1 where there is nothing to count.
double sign_test(std::size_t won, std::size_t lost);

/// Wilcoxon's signed-rank test: whether paired differences lie symmetrically about zero.
struct SignedRank {
  double p = 1.0;         ///< two-sided
  std::size_t n = 0;      ///< differences that are not zero; the others are left out
  double positive = 0.0;  ///< sum of the ranks, by size from 1, of those above zero
  double negative = 0.0;  ///< and of those below; ties share the mean of their ranks
  bool is_exact = false;  ///< else by the normal approximation, with correction for ties
};

/// Exact for at most kMostExactRanks differences without ties and zeros. `differences` are finite.
SignedRank signed_rank_test(std::span<const double> differences);
inline constexpr std::size_t kMostExactRanks = 50;

/// Adjusted p values of a family of tests (Holm 1979), in the order of `p`: where those below
/// 1 - level are called significant, the probability of one false call or more is at most that.
std::vector<double> holm(std::span<const double> p);

}  // namespace montecarta::analysis
