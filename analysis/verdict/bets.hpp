// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/sums.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// The side of a margin r on which the ratio of squared errors to the expected ones may lie.
enum class Side : std::uint8_t {
  above,  ///< the ratio is more than r
  below   ///< the ratio is less than 1 / r
};

/// The largest mean of exp(-s m) over all laws of m >= 0 with mean 1 and this variance: that of an
/// m which is either 0 or 1 + variance. It grows with the variance.
double largest_mean_exponential(double s, double variance);

/// Capital of a gambler who starts with 1 and bets, in every run, that the mean of its squared
/// whitened errors has an expectation beyond a margin (STATISTICS 18). If the expectation is within
/// the margin, the capital exceeds 1 / alpha at any time with a probability of at most alpha (J.
/// Ville: Etude critique de la notion de collectif, 1939), so it may be tested after every run.
/// Runs must be independent; errors within a run may depend on each other in any way. The method is
/// that of I. Waudby-Smith and A. Ramdas: Estimating means of bounded random variables by betting,
/// JRSS B 86, 2024; its use for tests of calibration is that of S. Arnold, A. Henzi, J. F. Ziegel:
/// Sequentially valid tests for forecast calibration, arXiv 2109.11761.
class Bets {
 public:
  /// Adds the mean of the squared errors of one run, which is at least 0; NaN is left out.
  void add(double mean_of_run);
  std::uint64_t runs() const { return runs_; }

  /// Logarithm of the capital. The bet `above` is fair for any distribution of the means. The bet
  /// `below` uses a safe estimate of the variance of the means; with fewer than kFewestRuns runs it
  /// is not made, and its logarithm is 0.
  double log_capital(Side side, double margin) const;

  static constexpr std::uint64_t kFewestRuns = 20;
  static constexpr auto parts() {
    return std::tuple(added(&Bets::runs_, &Bets::growth_, &Bets::powers_));
  }

 private:
  double log_capital_above(double margin) const;
  double log_capital_below(double margin) const;
  double safe_variance() const;

  static constexpr std::size_t kStakes = 11;
  std::uint64_t runs_ = 0;
  std::array<double, kStakes> growth_{};  ///< {stake} sum of log(1 + stake * mean of a run)
  std::array<double, 4> powers_{};        ///< sums of the first to fourth powers of these means
};

/// {family}{member} Bets on the judged ratios: size, component, stretch.
using FamiliesOfBets = std::span<const std::vector<Bets>>;

/// Logarithm of the mean over families of the mean capital of their members: families have equal
/// weights, whatever their number of members. -infinity without any bets.
double log_capital(FamiliesOfBets families, Side side, double margin);

/// The side of [1 / margin, margin] on which a ratio is shown to be at `level`; nullopt if neither
/// is shown. Half of the capital is bet on each side. If all ratios are inside the margin, a side
/// is returned with a probability of at most 1 - level, even if this is called after every run.
std::optional<Side> refused_side(FamiliesOfBets families, double margin, double level);

}  // namespace montecarta::analysis
