// SPDX-License-Identifier: BSD-3-Clause
// What became of detections in a run, in sums over its scans (AssociationCounts).
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/score.hpp"
#include "analysis/statistics/means.hpp"

namespace montecarta {
namespace {

template <std::vector<double> AssociationRows::*kCounts>
double sum_of_counts(const MeasuredRun& run) {
  return sum_of(run.rows.association.*kCounts);
}

}  // namespace

std::span<const Score> scores_of_association() {
  static constexpr Score kAll[] = {
      {"association_correct", "1", "detections rightly associated",
       sum_of_counts<&AssociationRows::correct>, Better::higher},
      {"association_wrong", "1", "detections given to a wrong landmark",
       sum_of_counts<&AssociationRows::wrong>},
      {"association_new_again", "1", "detections made new again",
       sum_of_counts<&AssociationRows::new_again>},
      {"association_missed", "1", "detections left out", sum_of_counts<&AssociationRows::missed>},
      {"association_clutter", "1", "false alarms accepted",
       sum_of_counts<&AssociationRows::clutter>},
  };
  return kAll;
}

}  // namespace montecarta
