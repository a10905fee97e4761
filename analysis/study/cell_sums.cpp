// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/cell_sums.hpp"

#include "analysis/run/criteria_of.hpp"
#include "analysis/statistics/bootstrap.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/study/registry.hpp"
#include "engine/threads/in_order.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

/// Fills CellAnalysis::score_intervals. All scores share one bootstrap over runs at `level`.
void put_score_intervals(CellAnalysis& cell, double level) {
  std::vector<std::vector<double>> columns;
  for (const Score& score : all_scores()) columns.push_back(cell.scores.column(score.name));
  cell.score_intervals = bootstrap_means(columns, level);
}

}  // namespace

void MeanOverTime::add(const std::vector<double>& values) {
  sum_.resize(values.size());
  for (std::size_t s = 0; s < values.size(); ++s) sum_[s] += values[s];
  runs_ += 1.0;
}

std::vector<double> MeanOverTime::mean() const {
  std::vector<double> means = sum_;
  for (double& mean : means) mean /= runs_;
  return means;
}

CellSums::CellSums(const RunCriteria& criteria)
    : level_(criteria.level), over_time_(criteria.drives.empty() ? all_scan_series().size() : 0) {
  for (const Metric& metric : all_metrics()) {
    if (metric.sums != nullptr) metrics_.push_back(metric.sums(criteria));
  }
}

void CellSums::add(const MeasuredRun& run) {
  scores_.add(run);
  for (const auto& metric : metrics_) metric->add(run);
  for (std::size_t k = 0; k < over_time_.size(); ++k) {
    const std::vector<double> values = all_scan_series()[k].of(run);
    if (!values.empty()) over_time_[k].add(values);
  }
}

void CellSums::merge(CellSums&& next) {
  merge_into(scores_, next.scores_);
  merge_into(over_time_, next.over_time_);
  for (std::size_t k = 0; k < metrics_.size(); ++k) metrics_[k]->merge(*next.metrics_[k]);
}

void CellSums::write(SumWriter& words) const {
  ScoreTable scores = scores_;
  scores.put("cpu_seconds", std::vector<double>(scores.runs(), kNaN));
  words.put(scores);
  words.put(over_time_);
  for (const auto& metric : metrics_) metric->write(words);
}

void CellSums::read(SumReader& words) {
  const std::size_t series = over_time_.size();
  words.get(scores_);
  words.get(over_time_);
  SumReader::expect(scores_.is_whole() && over_time_.size() == series);
  for (const auto& metric : metrics_) metric->read(words);
}

std::string CellSums::layout() const {
  std::string text;
  for (const Score& score : all_scores()) text += std::string(score.name) + ',';
  SumLayout<ScoreTable>::add(text);
  for (const ScanSeries& series : all_scan_series()) text += std::string(series.name) + ',';
  SumLayout<MeanOverTime>::add(text);
  for (const auto& metric : metrics_) metric->add_layout(text);
  return text;
}

void CellSums::put_series(CellAnalysis& cell) const {
  for (std::size_t k = 0; k < over_time_.size(); ++k) {
    if (over_time_[k].empty()) continue;
    const ScanSeries& series = all_scan_series()[k];
    std::vector<double> values = over_time_[k].mean();
    if (series.is_square) {
      for (double& value : values) value = std::sqrt(value);
    }
    cell.scan_series.push_back({series.name, series.units, std::move(values)});
  }
}

void CellSums::put(CellAnalysis& cell) {
  cell.complete = scores_.runs();
  put_series(cell);
  cell.scores = std::move(scores_);
  for (const auto& metric : metrics_) metric->put(cell);
  put_score_intervals(cell, level_);
}

namespace {

struct RunBlock {
  std::size_t cell;
  std::span<const std::size_t> runs;
  bool ends_group;
};

/// The number of runs, from the first on, that belong to one block.
std::size_t runs_of_block(std::span<const std::uint64_t> numbers) {
  const std::uint64_t end = (numbers.front() / engine::kRunsOfAGroup + 1) * engine::kRunsOfAGroup;
  const auto of_group = std::ranges::lower_bound(numbers, end) - numbers.begin();
  return std::min(kRunsOfABlock, static_cast<std::size_t>(of_group));
}

std::vector<RunBlock> run_blocks_of(std::span<const CellRuns> cells) {
  std::vector<RunBlock> blocks;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    auto numbers = cells[c].numbers;
    for (auto left = cells[c].runs; !left.empty();) {
      const std::size_t runs = runs_of_block(numbers);
      const bool ends_group = runs == left.size() || numbers[runs] / engine::kRunsOfAGroup !=
                                                         numbers.front() / engine::kRunsOfAGroup;
      blocks.push_back({c, left.first(runs), ends_group});
      left = left.subspan(runs);
      numbers = numbers.subspan(runs);
    }
  }
  return blocks;
}

CellSums sums_of_block(const CellRuns& cell, std::span<const std::size_t> runs,
                       const RunCriteria& criteria) {
  CellSums sums(criteria);
  MeasuredRun run;
  for (const std::size_t i : runs) {
    cell.reader->read(i, run.rows);
    run.measure(criteria, cell.reader->particles());
    sums.add(run);
  }
  return sums;
}

}  // namespace

std::vector<CellSums> sums_of(std::span<const CellRuns> cells, const RunCriteria& criteria,
                              const Parallel& parallel) {
  const std::vector<RunBlock> blocks = run_blocks_of(cells);
  std::vector<CellSums> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) sums.emplace_back(criteria);
  CellSums group(criteria);
  for_each_in_order(
      parallel, blocks.size(),
      [&](std::size_t b) { return sums_of_block(cells[blocks[b].cell], blocks[b].runs, criteria); },
      [&](std::size_t b, CellSums&& block) {
        group.merge(std::move(block));
        if (!blocks[b].ends_group) return;
        sums[blocks[b].cell].merge(std::move(group));
        group = CellSums(criteria);
      });
  return sums;
}

std::vector<double> first_values(const ResultFile& file, const StoredCell& cell, const Score& score,
                                 std::size_t runs, const Parallel& parallel) {
  const std::vector<RunStatus> status = file.status(cell);
  std::vector<std::size_t> complete;
  for (std::size_t i = 0; i < runs; ++i) {
    if (status[i] == RunStatus::complete) complete.push_back(i);
  }
  const RunCriteria criteria = criteria_of(file, kUsualLevel);
  const RunReader reader(file, cell);
  std::vector<std::uint64_t> numbers;
  for (const std::size_t i : complete) numbers.push_back(file.runs()[i]);
  const CellRuns all{&reader, complete, numbers};
  return sums_of({&all, 1}, criteria, parallel).front().scores().column(score.name);
}

bool is_precise(const std::vector<double>& values, double level, double wanted) {
  return summary_of(values).half_width(level) < wanted && !is_heavy_tailed(values);
}

}  // namespace montecarta::analysis
