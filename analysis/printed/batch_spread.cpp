// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/printed/batch_spread.hpp"

#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

std::string number_or_never(double value) {
  return std::isinf(value) ? "never" : readable(value, 3);
}

std::string of_batches(std::size_t some, std::size_t all) {
  return " in " + std::to_string(some) + " of " + std::to_string(all);
}

}  // namespace

BatchSpread spread_of_batches(std::vector<double> values, double level) {
  BatchSpread spread;
  if (values.size() < 2 || std::ranges::any_of(values, [](double v) { return std::isnan(v); })) {
    return spread;
  }
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  const auto cut = static_cast<std::size_t>(0.5 * (1.0 - level) * n);
  spread.batches = values.size();
  spread.never = static_cast<std::size_t>(
      std::ranges::count_if(values, [](double value) { return std::isinf(value); }));
  spread.median = median_of(values);
  spread.range = {values[cut], values[values.size() - 1 - cut]};
  return spread;
}

std::string in_words(const BatchSpread& spread) {
  if (spread.batches == 0) return "-";
  const std::string words = number_or_never(spread.median) + " [" +
                            number_or_never(spread.range.lower) + ", " +
                            number_or_never(spread.range.upper) + "]";
  return spread.never == 0 ? words : words + ", never" + of_batches(spread.never, spread.batches);
}

BatchClaim claim_over_batches(const std::vector<double>& left, const std::vector<double>& right,
                              char relation) {
  BatchClaim claim;
  std::vector<double> differences;
  for (std::size_t b = 0; b < std::min(left.size(), right.size()); ++b) {
    const double l = left[b], r = right[b];
    differences.push_back(l == r ? 0.0 : l - r);  // both may be infinite: never
    claim.holds += (relation == '<' ? l < r : l > r) ? 1 : 0;
    claim.contradicts += (relation == '<' ? l > r : l < r) ? 1 : 0;
  }
  claim.batches = differences.size();
  claim.difference = median_of(differences);
  return claim;
}

std::string in_words(const BatchClaim& claim) {
  if (claim.holds == claim.batches) {
    return "holds" + of_batches(claim.holds, claim.batches) + " batches";
  }
  if (claim.contradicts == claim.batches) {
    return "contradicted" + of_batches(claim.contradicts, claim.batches) + " batches";
  }
  return "undecided: holds" + of_batches(claim.holds, claim.batches) + " batches, contradicted" +
         of_batches(claim.contradicts, claim.batches);
}

}  // namespace montecarta::analysis
