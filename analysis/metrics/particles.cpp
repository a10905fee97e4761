// SPDX-License-Identifier: BSD-3-Clause
// Effective number of particles, and how many distinct ancestors they have (Diversity).
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"

namespace montecarta {
namespace {

using Counts = std::vector<std::uint32_t>;

template <Counts Diversity::*kCounts>
std::vector<double> counts_over_time(const MeasuredRun& run) {
  const Diversity* diversity = run.metrics.diversity();
  if (diversity == nullptr) return {};
  return {(diversity->*kCounts).begin(), (diversity->*kCounts).end()};
}

template <Counts Diversity::*kCounts>
double mean_of_counts(const MeasuredRun& run) {
  return mean_of(counts_over_time<kCounts>(run));
}

double first_with_descendants(const MeasuredRun& run) {
  const Diversity* diversity = run.metrics.diversity();
  return diversity == nullptr ? kNaN : diversity->root.back();
}

}  // namespace

std::span<const Score> scores_of_particles() {
  static constexpr Score kAll[] = {
      {"ess", "1", "effective particles",
       [](const MeasuredRun& run) { return mean_of(run.rows.ess); }, Better::higher},
      {"resampling_rate", "1", "share of scans that resample",
       [](const MeasuredRun& run) { return mean_of(run.rows.resampled); }, Better::neither},
      {"ancestors_last_resampling", "1", "distinct particles after a resampling",
       mean_of_counts<&Diversity::last_resampling>, Better::higher},
      {"ancestors_10_s_ago", "1", "distinct ancestors 10 s ago", mean_of_counts<&Diversity::lag>,
       Better::higher},
      {"ancestors_at_start", "1", "distinct ancestors at the start",
       mean_of_counts<&Diversity::root>, Better::higher},
      {"ancestors_at_start_at_the_end", "1", "first particles that have descendants at the end",
       first_with_descendants, Better::higher},
  };
  return kAll;
}
std::span<const ScanSeries> series_of_particles() {
  static constexpr ScanSeries kAll[] = {
      {"ess", "1", [](const MeasuredRun& run) { return run.rows.ess; }},
      {"ancestors_last_resampling", "1", counts_over_time<&Diversity::last_resampling>},
      {"ancestors_10_s_ago", "1", counts_over_time<&Diversity::lag>},
      {"ancestors_at_start", "1", counts_over_time<&Diversity::root>},
  };
  return kAll;
}

}  // namespace montecarta
