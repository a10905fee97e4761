// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/score.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <initializer_list>
#include <limits>

namespace montecarta {

// Each metric defines its own, in the file of that name.
std::span<const Score> scores_of_errors();
std::span<const Score> scores_of_nees();
std::span<const Score> scores_of_particles();
std::span<const Score> scores_of_lineages();
std::span<const Score> scores_of_association();
std::span<const Score> scores_of_references();
std::span<const Score> scores_of_beacons();
std::span<const Score> scores_of_map();
std::span<const Score> scores_of_joint();
std::span<const Score> scores_of_cost();
std::span<const ScanSeries> series_of_errors();
std::span<const ScanSeries> series_of_map_size();
std::span<const ScanSeries> series_of_particles();

namespace {

template <class T>
std::vector<T> joined(std::initializer_list<std::span<const T>> lists) {
  std::vector<T> all;
  for (const std::span<const T> list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace

std::span<const Score> all_scores() {
  static const std::vector<Score> all =
      joined<Score>({scores_of_errors(), scores_of_nees(), scores_of_particles(),
                     scores_of_lineages(), scores_of_association(), scores_of_references(),
                     scores_of_beacons(), scores_of_map(), scores_of_joint(), scores_of_cost()});
  return all;
}

std::span<const ScanSeries> all_scan_series() {
  static const std::vector<ScanSeries> all =
      joined<ScanSeries>({series_of_errors(), series_of_map_size(), series_of_particles()});
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

std::size_t index_of(const Score& score) { return index_of(score.name); }

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

const std::vector<double>& ScoreTable::column(const Score& score) const {
  return columns_[index_of(score)];
}

const std::vector<double>& ScoreTable::column(std::string_view name) const {
  return columns_[index_of(name)];
}

}  // namespace montecarta
