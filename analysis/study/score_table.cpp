// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/score_table.hpp"

#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <utility>

namespace montecarta::analysis {

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
  for (auto& column : columns_) column.resize(runs_, kNaN);
  for (const Value& value : values) columns_[index_of(value.name)].back() = value.value;
}

bool ScoreTable::is_whole() const {
  const auto is_full = [&](const std::vector<double>& column) { return column.size() == runs_; };
  return columns_.size() == all_scores().size() && std::ranges::all_of(columns_, is_full);
}

void ScoreTable::put(std::string_view name, std::vector<double> values) {
  expect(values.size() == runs_, "a score of other runs");
  columns_[index_of(name)] = std::move(values);
}

const std::vector<double>& ScoreTable::column(std::string_view name) const {
  return columns_[index_of(name)];
}

}  // namespace montecarta::analysis
