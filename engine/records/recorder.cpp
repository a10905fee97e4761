// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/recorder.hpp"

#include "engine/errors.hpp"
#include "engine/records/columns.hpp"

#include <algorithm>

namespace montecarta::engine {
namespace {

template <class T>
std::span<T> column(RunRecord& record, std::string_view name) {
  const auto c = record.layout().find(name);
  return c ? record.column<T>(*c) : std::span<T>();
}

/// Row `row` of a column with `width` elements per row; empty if the column is empty.
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

Recorder::Recorder(RunRecord& record) : layout_(&record.layout()), scans_(record.layout().scans()) {
  columns_.pose_mean = column<double>(record, "pose_mean");
  columns_.pose_covariance = column<double>(record, "pose_covariance");
  columns_.pose_mean_mixture = column<double>(record, "pose_mean_mixture");
  columns_.pose_covariance_mixture = column<double>(record, "pose_covariance_mixture");
  columns_.particle_pose = column<double>(record, "particle_pose");
  columns_.log_weight = column<double>(record, "log_weight");
  columns_.map = {column<double>(record, "map_mean"), column<double>(record, "map_covariance"),
                  column<std::uint8_t>(record, "map_seen")};
  columns_.final_map = {column<double>(record, "final_map_mean"),
                        column<double>(record, "final_map_covariance"),
                        column<std::uint8_t>(record, "final_map_seen")};
  columns_.joint_mean = column<double>(record, "joint_mean");
  columns_.joint_covariance = column<double>(record, "joint_covariance");
  columns_.numerical_faults = column<std::uint32_t>(record, "numerical_faults");
  const bool any = !columns_.map.mean.empty() || !columns_.final_map.mean.empty();
  landmarks_.resize(any ? layout_->landmarks() : 0);
  find_reported(record);
  find_own(record);
  choose_ancestor(record);
}

void Recorder::find_reported(RunRecord& record) {
  for (const ColumnKind& kind : column_table()) {
    const auto c = layout_->find(kind.name);
    if (kind.of_report == nullptr || !c) continue;
    switch (layout_->columns()[*c].element) {
      case Element::f64:
        reported_.push_back({kind.of_report, record.column<double>(*c)});
        break;
      case Element::u8:
        reported_.push_back({kind.of_report, record.column<std::uint8_t>(*c)});
        break;
      case Element::u32:
        reported_.push_back({kind.of_report, record.column<std::uint32_t>(*c)});
        break;
      case Element::u16:
      case Element::u64:
        expect(false, "a number of a scan is f64, u8 or u32");
    }
  }
}

void Recorder::find_own(RunRecord& record) {
  const std::vector<std::string>& names = layout_->own_columns();
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (const auto c = layout_->find(names[k])) own_.push_back({k, record.column<double>(*c)});
  }
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
  record_particles(filter, scan);
  record_map(filter, scan);
  record_joint(filter, scan);
  return recorded;
}

const PoseEstimate* Recorder::record_pose(const SlamFilter& filter, std::size_t row) {
  estimate_ = filter.estimate();
  copy(estimate_.spread.mean, row_of(columns_.pose_mean, row, 3));
  copy<3>(estimate_.spread.covariance, row_of(columns_.pose_covariance, row, 9));
  if (!estimate_.mixture) {
    if (!columns_.pose_mean_mixture.empty())
      throw StudyError(
          "the filter declares a mixture and estimates none: clear FilterKind::reports.mixture");
    return &estimate_;
  }
  copy(estimate_.mixture->mean, row_of(columns_.pose_mean_mixture, row, 3));
  copy<3>(estimate_.mixture->covariance, row_of(columns_.pose_covariance_mixture, row, 9));
  return &estimate_;
}

void Recorder::record_report(const ScanReport& report, std::size_t scan) {
  for (const Reported& reported : reported_) {
    const auto put = [&](auto column) {
      using Number = typename decltype(column)::value_type;
      column[scan] = static_cast<Number>(reported.value(report));
    };
    std::visit(put, reported.column);
  }
  if (report.own.size() != layout_->own_columns().size())
    throw StudyError(
        "the filter reports {} values of its own (it declares {}): set ScanReport::own at every "
        "update, to the columns that FilterKind::reports and restrict_reports leave",
        report.own.size(), layout_->own_columns().size());
  for (const Own& own : own_) own.column[scan] = report.own[own.index];
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
  const bool last = scan + 1 == scans_;
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
  std::ranges::copy(joint->covariance.reshaped(),  // symmetric, so rows and columns are equal
                    row_of(columns_.joint_covariance, row, states * states).begin());
  columns_.numerical_faults[scan] += joint->numerical_faults;
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

}  // namespace montecarta::engine
