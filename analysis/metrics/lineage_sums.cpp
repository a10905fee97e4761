// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/lineage_sums.hpp"

#include <cmath>

namespace montecarta::analysis {
void LineageSums::Mean::add(double value) {
  if (std::isnan(value)) return;
  sum += value;
  n += 1.0;
}

void LineageSums::add(const Lineages& lineages) {
  ++runs_;
  for (std::size_t lag = 0; lag < ancestors_.size(); ++lag) {
    ancestors_[lag].add(lineages.ancestors[lag]);
  }
  coalescence_.add(lineages.coalescence);
  coalesced_.add(lineages.coalesced_share);
  variance_.add(lineages.monte_carlo_variance);
  squared_error_.add(lineages.squared_error);
}

LineageSummary LineageSums::result() const {
  LineageSummary summary;
  for (std::size_t lag = 0; lag < ancestors_.size(); ++lag) {
    summary.ancestors[lag] = ancestors_[lag].value();
  }
  summary.coalescence = coalescence_.value();
  summary.coalesced_share = coalesced_.value();
  summary.monte_carlo_share = variance_.value() / squared_error_.value();
  return summary;
}

}  // namespace montecarta::analysis
