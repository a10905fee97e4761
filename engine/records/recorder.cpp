// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/recorder.hpp"

#include "engine/errors.hpp"

#include <algorithm>

namespace montecarta {
namespace {

template <class T>
std::span<T> column(RunRecord& record, std::string_view name) {
  const auto c = record.layout().find(name);
  return c ? record.column<T>(*c) : std::span<T>();
}

/// Row `row` of a column whose rows have `width` elements; empty where the column is.
template <class T>
std::span<T> row_of(std::span<T> column, std::size_t row, std::size_t width) {
  return column.empty() ? column : column.subspan(row * width, width);
}

void copy(const Pose& pose, std::span<double> row) {
  if (row.empty()) return;
  row[0] = pose.x;
  row[1] = pose.y;
  row[2] = pose.heading;
}

template <int N>
void copy(const Eigen::Matrix<double, N, N>& matrix, std::span<double> row) {
  if (row.empty()) return;
  Eigen::Map<Eigen::Matrix<double, N, N, Eigen::RowMajor>>(row.data()) = matrix;
}

}  // namespace

Recorder::Recorder(RunRecord& record) : layout_(&record.layout()) {
  columns_.pose_mean = column<double>(record, "pose_mean");
  columns_.pose_covariance = column<double>(record, "pose_covariance");
  columns_.pose_mean_mixture = column<double>(record, "pose_mean_mixture");
  columns_.pose_covariance_mixture = column<double>(record, "pose_covariance_mixture");
  columns_.ess = column<double>(record, "ess");
  columns_.resampled = column<std::uint8_t>(record, "resampled");
  columns_.log_likelihood = column<double>(record, "log_likelihood");
  columns_.nis = column<double>(record, "nis");
  columns_.nis_dof = column<std::uint32_t>(record, "nis_dof");
  columns_.numerical_faults = column<std::uint32_t>(record, "numerical_faults");
  columns_.correct = column<double>(record, "association_correct");
  columns_.wrong = column<double>(record, "association_wrong");
  columns_.new_again = column<double>(record, "association_new_again");
  columns_.missed = column<double>(record, "association_missed");
  columns_.clutter = column<double>(record, "association_clutter");
  columns_.particle_pose = column<double>(record, "particle_pose");
  columns_.log_weight = column<double>(record, "log_weight");
  columns_.map_size = column<double>(record, "map_size");
  columns_.map = {column<double>(record, "map_mean"), column<double>(record, "map_covariance"),
                  column<std::uint8_t>(record, "map_seen")};
  columns_.final_map = {column<double>(record, "final_map_mean"),
                        column<double>(record, "final_map_covariance"),
                        column<std::uint8_t>(record, "final_map_seen")};
  columns_.joint_mean = column<double>(record, "joint_mean");
  columns_.joint_covariance = column<double>(record, "joint_covariance");
  const bool any = !columns_.map.mean.empty() || !columns_.final_map.mean.empty();
  landmarks_.resize(any ? layout_->landmarks() : 0);
  choose_ancestor(record);
}

void Recorder::choose_ancestor(RunRecord& record) {
  const auto ancestor = layout_->find("ancestor");
  if (!ancestor) return;
  if (layout_->columns()[*ancestor].element == Element::u32) {
    columns_.ancestor_wide = record.column<std::uint32_t>(*ancestor);
  } else {
    columns_.ancestor_narrow = record.column<std::uint16_t>(*ancestor);
    ancestors_.resize(layout_->particles());
  }
}

const PoseEstimate* Recorder::after_step(const SlamFilter& filter, std::size_t step) {
  return layout_->scans_only() ? nullptr : record_pose(filter, step);
}

const PoseEstimate* Recorder::after_scan(const SlamFilter& filter, std::size_t scan) {
  const PoseEstimate* recorded = layout_->scans_only() ? record_pose(filter, scan) : nullptr;
  record_report(filter.report(), scan);
  record_association(filter.report().association, scan);
  record_particles(filter, scan);
  record_map(filter, scan);
  record_joint(filter, scan);
  return recorded;
}

const PoseEstimate* Recorder::record_pose(const SlamFilter& filter, std::size_t row) {
  estimate_ = filter.estimate();
  copy(estimate_.spread.mean, row_of(columns_.pose_mean, row, 3));
  copy<3>(estimate_.spread.covariance, row_of(columns_.pose_covariance, row, 9));
  if (!estimate_.mixture) return &estimate_;
  copy(estimate_.mixture->mean, row_of(columns_.pose_mean_mixture, row, 3));
  copy<3>(estimate_.mixture->covariance, row_of(columns_.pose_covariance_mixture, row, 9));
  return &estimate_;
}

void Recorder::record_report(const ScanReport& report, std::size_t scan) {
  columns_.ess[scan] = report.ess;
  columns_.resampled[scan] = report.resampled ? 1 : 0;
  columns_.log_likelihood[scan] = report.log_likelihood;
  columns_.nis[scan] = report.nis;
  columns_.nis_dof[scan] = report.nis_dof;
  columns_.numerical_faults[scan] = report.numerical_faults;
  columns_.map_size[scan] = report.map_size;
}

void Recorder::record_association(const AssociationCounts& counts, std::size_t scan) {
  if (columns_.correct.empty()) return;
  columns_.correct[scan] = counts.correct;
  columns_.wrong[scan] = counts.wrong;
  columns_.new_again[scan] = counts.new_again;
  columns_.missed[scan] = counts.missed;
  columns_.clutter[scan] = counts.clutter;
}

void Recorder::record_particles(const SlamFilter& filter, std::size_t scan) {
  const std::size_t n = layout_->particles();
  ParticleColumns wanted;
  wanted.pose = row_of(columns_.particle_pose, scan, 3 * n);
  wanted.log_weight = row_of(columns_.log_weight, scan, n);
  wanted.ancestor = columns_.ancestor_narrow.empty() ? row_of(columns_.ancestor_wide, scan, n)
                                                     : std::span(ancestors_);
  if (wanted.pose.empty() && wanted.log_weight.empty() && wanted.ancestor.empty()) return;
  filter.particles(wanted);
  if (columns_.ancestor_narrow.empty()) return;
  std::ranges::transform(ancestors_, row_of(columns_.ancestor_narrow, scan, n).begin(),
                         [](std::uint32_t parent) { return static_cast<std::uint16_t>(parent); });
}

void Recorder::record_map(const SlamFilter& filter, std::size_t scan) {
  const bool last = scan + 1 == layout_->scans();
  if (landmarks_.empty() || (columns_.map.mean.empty() && !last)) return;
  std::ranges::fill(landmarks_, std::nullopt);
  filter.map(landmarks_);
  if (!columns_.map.mean.empty()) write_map(columns_.map, scan);
  if (!columns_.final_map.mean.empty() && last) write_map(columns_.final_map, 0);
}

void Recorder::record_joint(const SlamFilter& filter, std::size_t scan) {
  const auto& scans = layout_->joint_scans();
  const auto found = std::ranges::lower_bound(scans, scan);
  if (found == scans.end() || *found != scan) return;
  const std::optional<JointEstimate> joint = filter.joint(layout_->landmarks());
  expect(joint.has_value(), "a joint estimate of a filter that has none");
  const auto row = static_cast<std::size_t>(found - scans.begin());
  const std::size_t states = columns_.joint_mean.size() / scans.size();
  std::ranges::copy(joint->mean, row_of(columns_.joint_mean, row, states).begin());
  std::ranges::copy(joint->covariance.reshaped(),  // symmetric: the order is one and the same
                    row_of(columns_.joint_covariance, row, states * states).begin());
}

void Recorder::write_map(const MapColumns& columns, std::size_t row) const {
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    if (!landmarks_[l]) continue;
    const std::size_t at = row * landmarks_.size() + l;
    columns.seen[at] = 1;
    columns.mean[2 * at] = landmarks_[l]->mean.x();
    columns.mean[2 * at + 1] = landmarks_[l]->mean.y();
    copy<2>(landmarks_[l]->covariance, row_of(columns.covariance, at, 4));
  }
}

}  // namespace montecarta
