// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/paired_runs.hpp"

#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// The runs of a cell that ended, with a value for each; NaN for a failed run.
struct EndedRuns {
  std::vector<std::uint64_t> runs;
  std::vector<double> values;
};

EndedRuns ended_runs(const CellAnalysis& cell, const Score& score) {
  std::vector<std::pair<std::uint64_t, double>> ended;
  const std::vector<double>& values = cell.scores.column(score.name);
  for (std::size_t i = 0; i < cell.runs.size(); ++i) ended.emplace_back(cell.runs[i], values[i]);
  for (const FailedRun& failure : cell.failures) ended.emplace_back(failure.run, kNaN);
  std::ranges::sort(ended, {}, &std::pair<std::uint64_t, double>::first);
  EndedRuns lists;
  for (const auto& [run, value] : ended) {
    lists.runs.push_back(run);
    lists.values.push_back(value);
  }
  return lists;
}

}  // namespace

bool are_equal(double a, double b) {
  constexpr double kRoundingOfTie = 1e-9;
  return a == b || std::abs(a - b) <= kRoundingOfTie * std::min(std::abs(a), std::abs(b));
}

std::vector<std::pair<std::size_t, std::size_t>> common_places(
    std::span<const std::uint64_t> left, std::span<const std::uint64_t> right) {
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::size_t l = 0, r = 0; l < left.size(); ++l) {
    while (r < right.size() && right[r] < left[l]) ++r;
    if (r < right.size() && right[r] == left[l]) places.emplace_back(l, r);
  }
  return places;
}

std::vector<double> PairedRuns::differences() const {
  std::vector<double> differences(left.size());
  std::ranges::transform(left, right, differences.begin(),
                         [](double l, double r) { return are_equal(l, r) ? 0.0 : l - r; });
  return differences;
}

PairedRuns paired_runs(const CellAnalysis& left, const CellAnalysis& right, const Score& score) {
  const EndedRuns l = ended_runs(left, score), r = ended_runs(right, score);
  const auto places = common_places(l.runs, r.runs);
  PairedRuns pairs;
  for (const auto& [i, j] : places) {
    const bool has_left = std::isfinite(l.values[i]), has_right = std::isfinite(r.values[j]);
    if (has_left && has_right) {
      pairs.left.push_back(l.values[i]);
      pairs.right.push_back(r.values[j]);
    } else {
      ++(has_left ? pairs.left_alone : has_right ? pairs.right_alone : pairs.neither);
    }
  }
  pairs.unpaired = l.runs.size() + r.runs.size() - 2 * places.size();
  return pairs;
}

bool has_score(const CellAnalysis& cell, const Score& score) {
  return std::ranges::any_of(cell.scores.column(score.name),
                             [](double value) { return std::isfinite(value); });
}

bool is_judged_by(const CellAnalysis& cell, const Score& score) {
  return has_score(cell, score) || (cell.complete == 0 && !cell.failures.empty());
}

}  // namespace montecarta::analysis
