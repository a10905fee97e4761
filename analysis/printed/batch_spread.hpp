// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/nees_bounds.hpp"

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// What batches of the paper's size say of one number; it may be infinite: never.
struct BatchSpread {
  std::size_t batches = 0;
  std::size_t never = 0;  ///< of them, infinite
  double median = std::numeric_limits<double>::quiet_NaN();
  Interval range = {median, median};  ///< that `level` of them lie in, of few batches all
};

/// Nothing of fewer than two batches, or where one has no number.
BatchSpread spread_of_batches(std::vector<double> values, double level);

/// "80 [61, never], never in 3 of 10"; "-" of nothing.
std::string in_words(const BatchSpread& spread);

/// In how many batches the left number is on the claimed side of the right one ('<' or '>'), and in
/// how many on the other; the same number is on neither.
struct BatchClaim {
  std::size_t batches = 0, holds = 0, contradicts = 0;
  double difference = std::numeric_limits<double>::quiet_NaN();  ///< median over batches
};
BatchClaim claim_over_batches(const std::vector<double>& left, const std::vector<double>& right,
                              char relation);

/// "holds in 10 of 10 batches"; "undecided: ..." where some batches say so and others not.
std::string in_words(const BatchClaim& claim);

}  // namespace montecarta::analysis
