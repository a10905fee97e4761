// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/lineage_sums.hpp"

#include <cmath>

namespace montecarta::analysis {
namespace {

template <std::size_t kLag>
double ancestors_ago(const LineageSummary& found) {
  return found.ancestors[kLag];
}

/// Text of the age of the common ancestor; "-" if there is none.
std::string common_ancestor_text(double coalescence) {
  return std::isfinite(coalescence) ? readable(coalescence) + " s" : "-";
}

}  // namespace

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

const std::vector<ResultNumber<LineageSummary>>& lineage_numbers() {
  static const std::vector<ResultNumber<LineageSummary>> all = {
      {"distinct_ancestors_1_s_ago", "1", ancestors_ago<0>, "ancestors, 1 s ago"},
      {"distinct_ancestors_2_s_ago", "1", ancestors_ago<1>},
      {"distinct_ancestors_5_s_ago", "1", ancestors_ago<2>},
      {"distinct_ancestors_10_s_ago", "1", ancestors_ago<3>, "10 s ago"},
      {"distinct_ancestors_20_s_ago", "1", ancestors_ago<4>},
      {"distinct_ancestors_50_s_ago", "1", ancestors_ago<5>},
      {"distinct_ancestors_100_s_ago", "1", ancestors_ago<6>, "100 s ago"},
      {"coalescence", "s", &LineageSummary::coalescence, "common ancestor", common_ancestor_text},
      {"coalesced_share", "1", &LineageSummary::coalesced_share, "scans with one", percent},
      {"monte_carlo_share", "1", &LineageSummary::monte_carlo_share, "Monte Carlo share", percent}};
  return all;
}

}  // namespace montecarta::analysis
