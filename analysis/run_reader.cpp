// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run_reader.hpp"

#include <algorithm>

namespace montecarta {
namespace {

constexpr std::string_view kFinalMapSeen = "final_map_seen";

}  // namespace

RunReader::RunReader(const ResultFile& file, const StoredCell& cell)
    : file_(&file), cell_(&cell), cpu_seconds_(file.cpu_seconds(cell)) {}

void RunReader::keep_scans(std::span<const double> all, std::size_t width,
                           std::vector<double>& out) const {
  out.clear();
  for (const std::size_t row : file_->scan_rows()) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(row * width);
    out.insert(out.end(), begin, begin + static_cast<std::ptrdiff_t>(width));
  }
}

void RunReader::read_truth(std::size_t i, std::vector<double>& out, Scratch& scratch) const {
  out.clear();
  if (!file_->has_truth()) return;
  scratch.resize(file_->times().size() * 3);
  {
    const std::lock_guard lock(reading_);
    file_->read_truth(i, scratch);
  }
  keep_scans(scratch, 3, out);
}

void RunReader::read_at_scans(std::string_view column, std::size_t width, std::size_t i,
                              std::vector<double>& out, Scratch& scratch) const {
  out.clear();
  if (!cell_->has(column)) return;
  scratch.resize(file_->times().size() * width);
  {
    const std::lock_guard lock(reading_);
    file_->read(*cell_, column, i, std::span(scratch));
  }
  keep_scans(scratch, width, out);
}

void RunReader::read_path(std::size_t i, std::vector<double>& out) const {
  out.clear();
  if (file_->references().empty()) return;
  out.resize(file_->times().size() * 3);
  const bool mixture = cell_->has("pose_mean_mixture");
  const std::lock_guard lock(reading_);
  file_->read(*cell_, mixture ? "pose_mean_mixture" : "pose_mean", i, std::span(out));
}

void RunReader::read_final_map(std::size_t i, RunRows& rows) const {
  rows.final_map.reset();
  const auto seen_column = std::ranges::find(cell_->columns, kFinalMapSeen, &Column::name);
  if (seen_column == cell_->columns.end()) return;
  std::vector<double> seen(seen_column->elements()), mean(2 * seen.size());
  if (!rows.map_size.empty() && rows.map_size.back() > static_cast<double>(seen.size()))
    return;  // record.map_rows left part of it out
  const std::lock_guard lock(reading_);
  file_->read(*cell_, kFinalMapSeen, i, std::span(seen));
  file_->read(*cell_, "final_map_mean", i, std::span(mean));
  rows.final_map.emplace();
  for (std::size_t l = 0; l < seen.size(); ++l) {
    if (seen[l] != 0.0) rows.final_map->emplace_back(mean[2 * l], mean[2 * l + 1]);
  }
}

template <class Number>
void RunReader::read_scans(std::string_view column, std::size_t width, std::size_t i,
                           std::vector<Number>& out) const {
  out.clear();
  if (!cell_->has(column)) return;
  out.resize(file_->scan_times().size() * width);
  const std::lock_guard lock(reading_);
  file_->read(*cell_, column, i, std::span(out));
}

void RunReader::read(std::size_t i, RunRows& rows, Scratch& scratch) const {
  read_truth(i, rows.truth, scratch);
  read_at_scans("pose_mean", 3, i, rows.spread.mean, scratch);
  read_at_scans("pose_covariance", 9, i, rows.spread.covariance, scratch);
  read_at_scans("pose_mean_mixture", 3, i, rows.mixture.mean, scratch);
  read_at_scans("pose_covariance_mixture", 9, i, rows.mixture.covariance, scratch);
  read_scans("numerical_faults", 1, i, rows.numerical_faults);
  read_scans("association_correct", 1, i, rows.association.correct);
  read_scans("association_wrong", 1, i, rows.association.wrong);
  read_scans("association_new_again", 1, i, rows.association.new_again);
  read_scans("association_missed", 1, i, rows.association.missed);
  read_scans("association_clutter", 1, i, rows.association.clutter);
  read_path(i, rows.path);
  read_scans("map_size", 1, i, rows.map_size);
  read_final_map(i, rows);
  rows.cpu_seconds = cpu_seconds_[i];
  rows.ess.clear();
  rows.resampled.clear();
  rows.ancestor.clear();
  if (cell_->particles == 0) return;
  read_scans("ess", 1, i, rows.ess);
  read_scans("resampled", 1, i, rows.resampled);
  read_scans("ancestor", cell_->particles, i, rows.ancestor);
}

}  // namespace montecarta
