// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/score.hpp"

#include "analysis/metrics/metric.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <limits>

namespace montecarta::analysis {
namespace {

template <class T>
std::vector<T> all_of(std::span<const T> Metric::*list) {
  std::vector<T> all;
  for (const Metric& metric : all_metrics()) {
    all.insert(all.end(), (metric.*list).begin(), (metric.*list).end());
  }
  return all;
}

}  // namespace

std::span<const Score> all_scores() {
  static const std::vector<Score> all = all_of(&Metric::scores);
  return all;
}

std::span<const ScanSeries> all_scan_series() {
  static const std::vector<ScanSeries> all = all_of(&Metric::scan_series);
  return all;
}

const Score* find_score(std::string_view name) {
  const auto found = std::ranges::find(all_scores(), name, &Score::name);
  return found == all_scores().end() ? nullptr : &*found;
}

std::size_t index_of(std::string_view name) {
  const Score* score = find_score(name);
  expect(score != nullptr, "a score that no metric declares");
  return static_cast<std::size_t>(score - all_scores().data());
}

ScoreTable::ScoreTable() : columns_(all_scores().size()) {}

void ScoreTable::add(const MeasuredRun& run) {
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    columns_[k].push_back(all_scores()[k].of(run));
  }
  ++runs_;
}

void ScoreTable::add(std::span<const Value> values) {
  ++runs_;
  for (auto& column : columns_) column.resize(runs_, std::numeric_limits<double>::quiet_NaN());
  for (const Value& value : values) columns_[index_of(value.name)].back() = value.value;
}

const std::vector<double>& ScoreTable::column(std::string_view name) const {
  return columns_[index_of(name)];
}

}  // namespace montecarta::analysis
