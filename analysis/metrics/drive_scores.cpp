// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/drive_scores.hpp"

#include "analysis/metrics/consistency.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kFewestFixes = 2;
constexpr double kSameWithin = 1e-3;  // [standard deviations of a fix]

/// Largest squared length of {component}{sample}.
double farthest_square(const VectorSeries& series) {
  double farthest = 0.0;
  for (std::size_t t = 0; t < series.front().size(); ++t) {
    double square = 0.0;
    for (const auto& component : series) square += component[t] * component[t];
    farthest = std::max(farthest, square);
  }
  return farthest;
}

void judge_leading(const FixErrors& errors, double level, DriveScores& scores) {
  scores.fixes = errors.nees.size();
  scores.in_gaps = errors.in_gaps;
  scores.undefined = errors.undefined;
  if (scores.fixes < kFewestFixes) return;
  scores.median = median_of(errors.nees) / expected_median(dimension_of(scores.leading));
  scores.seconds = errors.times.back() - errors.times.front();
  scores.is_the_reference = farthest_square(errors.by_reference) < kSameWithin * kSameWithin;
  scores.is_below_reference = correlated_average(errors.by_reference, level).ratio.upper < 1.0;
}

}  // namespace

DriveScores drive_scores(const PathAtFixes& fixes, std::span<const double> scan_times,
                         const RunRows& rows, std::size_t particles, double level) {
  DriveScores scores;
  scores.leading = fixes.headings().empty() ? ErrorBlock::position : ErrorBlock::pose;
  for (const ErrorBlock block : kErrorBlocks) {
    FixErrors errors = errors_at_fixes(fixes, scan_times, rows, particles, block);
    if (block == scores.leading) judge_leading(errors, level, scores);
    if (errors.nees.size() < kFewestFixes) continue;
    scores.blocks[static_cast<std::size_t>(block)] = correlated_average(errors.whitened, level);
    scores.errors[static_cast<std::size_t>(block)] = std::move(errors.whitened);
  }
  return scores;
}

}  // namespace montecarta::analysis
