// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/record_layout.hpp"

#include <algorithm>

namespace montecarta {
namespace {

constexpr std::size_t kAlignment = 64;  // a cache line, so that no two columns share one

struct Lengths {
  std::size_t rows, scans, joint;
};

std::size_t length_of(Axis axis, const Cell& cell, const Lengths& lengths) {
  switch (axis) {
    case Axis::time:
      return lengths.rows;
    case Axis::scan:
      return lengths.scans;
    case Axis::particle:
      return cell.particles;
    case Axis::landmark:
      return cell.landmarks;
    case Axis::component:
    case Axis::component_column:
      return 3;
    case Axis::coordinate:
    case Axis::coordinate_column:
      return 2;
    case Axis::joint:
      return lengths.joint;
    case Axis::state:
    case Axis::state_column:
      return 3 + 2 * cell.landmarks;
  }
  return 0;
}

std::vector<Column> pose_columns(const Cell& cell, const ColumnSelection& selection) {
  using enum Axis;
  const std::vector<Axis> vector = {time, component};
  const std::vector<Axis> matrix = {time, component, component_column};
  const std::string units = "m, m, rad";
  const std::string squared = "(m, m, rad)^2";
  std::vector<Column> columns = {{"pose_mean", Element::f64, vector, {}, units, "estimated pose"}};
  if (!selection.covariance) return columns;
  columns.push_back(
      {"pose_covariance",
       Element::f64,
       matrix,
       {},
       squared,
       "covariance of the pose: spread of the weighted particles, or the Gaussian's"});
  if (!cell.mixture) return columns;
  columns.push_back({"pose_mean_mixture",
                     Element::f64,
                     vector,
                     {},
                     units,
                     "mean of the Gaussian mixture before sampling"});
  columns.push_back({"pose_covariance_mixture",
                     Element::f64,
                     matrix,
                     {},
                     squared,
                     "covariance of the mixture: spread plus each particle's own"});
  return columns;
}

std::vector<Column> report_columns() {
  const std::vector<Axis> axes = {Axis::scan};
  return {
      {"ess", Element::f64, axes, {}, "1", "effective sample size after weighing"},
      {"resampled", Element::u8, axes, {}, "1", "1 where the scan ended with a resampling"},
      {"log_likelihood", Element::f64, axes, {}, "1", "log density of the scan given the past"},
      {"nis", Element::f64, axes, {}, "1", "normalised innovation squared of the scan"},
      {"nis_dof", Element::u32, axes, {}, "1", "degrees of freedom of nis"},
      {"numerical_faults", Element::u32, axes, {}, "1", "factorisations answered by a fallback"},
      {"map_size", Element::f64, axes, {}, "1", "landmarks in the map, mean over the particles"},
  };
}

std::vector<Column> association_columns(const ColumnSelection& selection) {
  if (!selection.association) return {};
  const std::vector<Axis> axes = {Axis::scan};
  const std::string mean = ", mean over the weighted particles";
  return {
      {"association_correct",
       Element::f64,
       axes,
       {},
       "1",
       "detections given to their landmark, or made new where the map had none" + mean},
      {"association_wrong",
       Element::f64,
       axes,
       {},
       "1",
       "detections given to another landmark" + mean},
      {"association_new_again",
       Element::f64,
       axes,
       {},
       "1",
       "detections made new though the map had their landmark" + mean},
      {"association_missed",
       Element::f64,
       axes,
       {},
       "1",
       "detections of a landmark that were left out" + mean},
      {"association_clutter",
       Element::f64,
       axes,
       {},
       "1",
       "false alarms given to a landmark or made new" + mean},
  };
}

std::vector<Column> particle_columns(const Cell& cell, const ColumnSelection& selection) {
  using enum Axis;
  std::vector<Column> columns;
  if (cell.particles == 0) return columns;
  if (selection.ancestry) {
    const Element element = cell.particles <= 65535 ? Element::u16 : Element::u32;
    columns.push_back({"ancestor",
                       element,
                       {scan, particle},
                       {},
                       "1",
                       "index of the particle's parent one scan ago"});
  }
  if (selection.particles) {
    columns.push_back({"particle_pose",
                       Element::f64,
                       {scan, particle, component},
                       {},
                       "m, m, rad",
                       "poses of the particles after drawing, before resampling"});
    columns.push_back({"log_weight",
                       Element::f64,
                       {scan, particle},
                       {},
                       "1",
                       "normalised log weights of the particles"});
  }
  return columns;
}

/// The map at all that `before` counts.
void add_map(const std::string& prefix, const std::vector<Axis>& before,
             std::vector<Column>& columns) {
  using enum Axis;
  const auto axes = [&](std::initializer_list<Axis> own) {
    std::vector<Axis> all = before;
    all.insert(all.end(), own);
    return all;
  };
  columns.push_back(
      {prefix + "mean", Element::f64, axes({landmark, coordinate}), {}, "m", "estimated landmark"});
  columns.push_back({prefix + "covariance",
                     Element::f64,
                     axes({landmark, coordinate, coordinate_column}),
                     {},
                     "m2",
                     "covariance of the landmark"});
  columns.push_back({prefix + "seen",
                     Element::u8,
                     axes({landmark}),
                     {},
                     "1",
                     "1 once the landmark is in the map"});
}

std::vector<Column> map_columns(const Cell& cell, const ColumnSelection& selection) {
  std::vector<Column> columns;
  if (cell.landmarks == 0) return columns;
  if (selection.map) add_map("map_", {Axis::scan}, columns);
  if (selection.final_map) add_map("final_map_", {}, columns);
  return columns;
}

std::vector<Column> joint_columns(const Cell& cell, const ColumnSelection& selection,
                                  std::size_t scans) {
  using enum Axis;
  if (!selection.joint || !cell.joint || scans == 0) return {};
  return {{"joint_mean",
           Element::f64,
           {joint, state},
           {},
           "m, m, rad, m",
           "estimated pose and landmarks together"},
          {"joint_covariance",
           Element::f64,
           {joint, state, state_column},
           {},
           "(m, m, rad, m)^2",
           "covariance of the pose and all landmarks together"}};
}

}  // namespace

RecordLayout::RecordLayout(const Cell& cell, const ColumnSelection& selection,
                           const Itinerary& itinerary)
    : columns_(pose_columns(cell, selection)),
      scans_only_(selection.scans_only),
      scans_(itinerary.scans()),
      particles_(cell.particles),
      landmarks_(cell.landmarks) {
  for (auto group :
       {report_columns(), association_columns(selection), particle_columns(cell, selection),
        map_columns(cell, selection), joint_columns(cell, selection, scans_)})
    columns_.insert(columns_.end(), group.begin(), group.end());
  if (selection.joint && cell.joint) joint_scans_ = joint_scans_of(scans_, selection.joint_scans);
  const Lengths lengths{scans_only_ ? scans_ : itinerary.steps(), scans_, joint_scans_.size()};
  for (Column& column : columns_) {
    for (Axis axis : column.axes) column.shape.push_back(length_of(axis, cell, lengths));
    offsets_.push_back(bytes_);
    bytes_ += (column.bytes() + kAlignment - 1) / kAlignment * kAlignment;
  }
}

std::optional<std::size_t> RecordLayout::find(std::string_view name) const {
  const auto found = std::find_if(columns_.begin(), columns_.end(),
                                  [&](const Column& column) { return column.name == name; });
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

}  // namespace montecarta
