// SPDX-License-Identifier: BSD-3-Clause
// Our runs in batches of the size of a paper's study: its one number is one of their distribution.
#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/nees_batches.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/statistics/means.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace montecarta::analysis {
namespace {

/// Adds what a band {scan} says of one batch; scans without a number count for neither side.
void add_batch(std::span<const double> average, std::span<const Interval> band,
               std::span<const double> times, BatchNumbers& numbers) {
  double judged = 0.0, inside = 0.0, above = 0.0;
  double from = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < average.size(); ++s) {
    if (std::isnan(average[s])) continue;
    const bool is_above = average[s] > band[s].upper;
    judged += 1.0;
    above += is_above ? 1.0 : 0.0;
    inside += !is_above && average[s] >= band[s].lower ? 1.0 : 0.0;
    from = is_above ? std::min(from, times[s]) : std::numeric_limits<double>::infinity();
  }
  numbers.share_inside.push_back(inside / judged);
  numbers.share_above.push_back(above / judged);
  numbers.stays_above_from.push_back(judged > 0.0 ? from
                                                  : std::numeric_limits<double>::quiet_NaN());
}

/// The batches of one block, one after the other.
class BatchesOfBlock {
 public:
  BatchesOfBlock(ErrorBlock block, const RunCriteria& criteria)
      : criteria_(&criteria), sum_(criteria.times.size()), runs_(criteria.times.size()) {
    found_.block = block;
  }
  void add(std::span<const double> nees) {
    for (std::size_t s = 0; s < nees.size(); ++s) {
      if (!std::isfinite(nees[s])) continue;
      sum_[s] += nees[s];
      ++runs_[s];
    }
    if (++in_batch_ == criteria_->printed.runs) end_batch();
  }
  const BlockBatches& found() const { return found_; }

 private:
  void end_batch() {
    std::vector<double> average;
    std::vector<Interval> expected;
    for (std::size_t s = 0; s < sum_.size(); ++s) {
      average.push_back(sum_[s] / static_cast<double>(runs_[s]));  // NaN of none
      expected.push_back(band_of(runs_[s]));
    }
    add_batch(average, expected, criteria_->times, found_.by_expected);
    if (const PrintedBand* band = criteria_->printed.find_band(name_of(found_.block))) {
      const std::vector<Interval> printed(average.size(), {band->lower, band->upper});
      add_batch(average, printed, criteria_->times, found_.by_printed);
    }
    std::ranges::fill(sum_, 0.0);
    std::ranges::fill(runs_, 0);
    in_batch_ = 0;
  }
  Interval band_of(std::uint64_t runs) {
    const auto [at, is_new] = bands_.try_emplace(runs);
    if (is_new && runs > 0)
      at->second = nees_bounds(runs, dimension_of(found_.block), criteria_->level);
    return at->second;
  }

  const RunCriteria* criteria_;
  std::vector<double> sum_;          ///< {scan} of the batch
  std::vector<std::uint64_t> runs_;  ///< {scan} in the sum
  std::uint64_t in_batch_ = 0;
  std::map<std::uint64_t, Interval> bands_;
  BlockBatches found_;
};

class NeesBatchesOverRuns final : public MetricSums {
 public:
  explicit NeesBatchesOverRuns(const RunCriteria& criteria) : runs_(criteria.printed.runs) {
    for (const ErrorBlock block : kErrorBlocks) blocks_.emplace_back(block, criteria);
  }
  void add(const MeasuredRun& run) override {
    const NeesRows* const nees = run.metrics.leading_nees();
    if (runs_ == 0 || nees == nullptr) return;
    for (std::size_t b = 0; b < blocks_.size(); ++b) blocks_[b].add(nees->value[b]);
  }
  void put(CellAnalysis& cell) override {
    NeesBatches found{runs_, {}};
    for (const BatchesOfBlock& block : blocks_) {
      if (!block.found().by_expected.share_inside.empty()) found.blocks.push_back(block.found());
    }
    cell.findings.put(std::move(found));
  }

 private:
  std::uint64_t runs_;
  std::vector<BatchesOfBlock> blocks_;
};

}  // namespace

const BlockBatches* NeesBatches::find(ErrorBlock block) const {
  const auto found = std::ranges::find(blocks, block, &BlockBatches::block);
  return found == blocks.end() ? nullptr : &*found;
}

Metric nees_batches_metric() { return {.sums = make_sums<NeesBatchesOverRuns>}; }

}  // namespace montecarta::analysis
