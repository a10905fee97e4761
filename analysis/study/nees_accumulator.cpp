// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/nees_accumulator.hpp"

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/run_mean.hpp"
#include "analysis/statistics/spread.hpp"

#include <cmath>
#include <map>

namespace montecarta::analysis {
namespace {

/// Fills the shares of scans whose average is outside the bounds.
void count_shares(NeesResult& result) {
  const NeesSeries& series = result.series;
  double tested = 0.0, above = 0.0, below = 0.0;
  for (std::size_t s = 0; s < series.average.size(); ++s) {
    const double average = series.average[s];
    if (std::isnan(average)) continue;
    tested += 1.0;
    above += average > series.bounds[s].upper ? 1.0 : 0.0;
    below += average < series.bounds[s].lower ? 1.0 : 0.0;
  }
  result.share_above = above / tested;
  result.share_below = below / tested;
}

}  // namespace

NeesAccumulator::NeesAccumulator(ErrorBlock block, Moments moments, std::size_t scans,
                                 std::size_t dimension)
    : block_(block),
      moments_(moments),
      dimension_(dimension == 0 ? dimension_of(block) : dimension),
      sum_(scans),
      runs_(scans) {}

void NeesAccumulator::add(const RunMetrics& metrics) {
  const auto block = static_cast<std::size_t>(block_);
  const NeesRows& rows = metrics.nees(moments_);
  add(rows.value[block], rows.rank[block], rows.too_few[block]);
}

void NeesAccumulator::add(std::span<const double> value, std::span<const int> rank,
                          std::span<const std::uint8_t> too_few) {
  for (std::size_t s = 0; s < value.size(); ++s) {
    if (!rank.empty() && rank[s] == Nees::kMissing) continue;
    ++samples_;
    const bool has_lower_rank =
        !rank.empty() && rank[s] >= 0 && static_cast<std::size_t>(rank[s]) < dimension_;
    if (has_lower_rank) ++lower_rank_;
    if (!std::isfinite(value[s])) {
      if (!too_few.empty() && too_few[s] != 0) {
        ++too_few_;
      } else if (!has_lower_rank) {
        ++unusable_;
      }
      continue;
    }
    sum_[s] += value[s];
    ++runs_[s];
  }
  const double average = mean_of_finite(value);
  if (std::isnan(average)) {
    ++unjudged_runs_;
  } else {
    run_averages_.push_back(average);
  }
}

NeesSeries NeesAccumulator::series(double level) const {
  NeesSeries series;
  series.dimension = dimension_;
  series.samples = samples_;
  series.lower_rank = lower_rank_;
  series.unusable = unusable_;
  series.missing = (run_averages_.size() + unjudged_runs_) * sum_.size() - samples_;
  series.too_few = too_few_;
  series.runs = runs_;
  series.run_averages = run_averages_;
  series.unjudged_runs = unjudged_runs_;
  // Bounds by number of runs, which is nearly the same at all scans.
  std::map<std::uint32_t, Interval> bounds;
  for (std::size_t s = 0; s < sum_.size(); ++s) {
    const auto [found, is_new] = bounds.try_emplace(runs_[s]);
    if (is_new && runs_[s] > 0) found->second = nees_bounds(runs_[s], dimension_, level);
    series.bounds.push_back(found->second);
    series.average.push_back(sum_[s] / runs_[s]);  // NaN if no run is valid
  }
  return series;
}

/// The interval by the law by which the verdict judges its ratio (STATISTICS 5.1). The two agree if
/// the verdict has the same level and no component is known exactly.
Interval NeesAccumulator::interval_of_mean(double level) const {
  const auto expected = static_cast<double>(dimension_);
  SummaryOf ratios;
  for (const double average : run_averages_) ratios.add(average / expected);
  const Interval ratio = RunMean::of_ratio(ratios.result()).interval(level);
  return {expected * ratio.lower, expected * ratio.upper};
}

NeesResult NeesAccumulator::result(double level) const {
  NeesResult result{
      block_, moments_, series(level), mean_of_finite(run_averages_), interval_of_mean(level),
      0.0,    0.0};
  count_shares(result);
  return result;
}

}  // namespace montecarta::analysis
