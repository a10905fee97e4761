// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run_reader.hpp"

#include <algorithm>

namespace montecarta {

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
