// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/columns.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

namespace montecarta::engine {
namespace {

/// Names of the axes, in the order of Axis.
constexpr std::array<std::string_view, 13> kAxisNames = {"time",
                                                         "scan",
                                                         "particle",
                                                         "landmark",
                                                         "component",
                                                         "component_column",
                                                         "coordinate",
                                                         "coordinate_column",
                                                         "joint",
                                                         "state",
                                                         "state_column",
                                                         "error_component",
                                                         "error_component_column"};
static_assert(kAxisNames.size() == static_cast<std::size_t>(Axis::error_component_column) + 1);

}  // namespace

std::size_t size_of(Element element) {
  switch (element) {
    case Element::u8:
      return 1;
    case Element::u16:
      return 2;
    case Element::u32:
      return 4;
    case Element::f64:
    case Element::u64:
      return 8;
  }
  expect(false, "an element of unknown type");
  return 0;
}

std::vector<std::uint32_t> joint_scans_of(std::size_t all, std::size_t wanted) {
  const std::size_t count = std::min(all, wanted);
  std::vector<std::uint32_t> scans(count);
  for (std::size_t k = 0; k < count; ++k) {
    scans[k] = static_cast<std::uint32_t>((k + 1) * all / count - 1);
  }
  return scans;
}

std::string_view name_of(Axis axis) { return kAxisNames[static_cast<std::size_t>(axis)]; }

std::optional<Axis> axis_named(std::string_view name) {
  const auto found = std::ranges::find(kAxisNames, name);
  if (found == kAxisNames.end()) return std::nullopt;
  return static_cast<Axis>(found - kAxisNames.begin());
}

std::size_t Column::elements() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

namespace {

constexpr ColumnGroup kGroups[] = {{"pose", nullptr},
                                   {"covariance", &ColumnSelection::covariance},
                                   {"ancestry", &ColumnSelection::ancestry},
                                   {"particles", &ColumnSelection::particles},
                                   {"association", &ColumnSelection::association},
                                   {"map", &ColumnSelection::map},
                                   {"final_map", &ColumnSelection::final_map},
                                   {"joint", &ColumnSelection::joint},
                                   {"observability", &ColumnSelection::observability},
                                   {"evolution", &ColumnSelection::evolution},
                                   {"sums", &ColumnSelection::sums}};

bool has_mixture(const Cell& cell) { return cell.reports.mixture; }
bool has_particles(const Cell& cell) { return cell.particles > 0; }
bool has_map(const Cell& cell) { return cell.landmarks > 0; }
bool has_joint(const Cell& cell) { return cell.reports.joint; }
bool is_imported(const Cell& cell) { return cell.imported.has_value(); }
bool is_filter(const Cell& cell) { return !is_imported(cell); }
bool has_imported_error(const Cell& cell) {
  return is_imported(cell) && cell.imported->components > 0;
}
bool has_pose(const Cell& cell) { return is_filter(cell) || cell.imported->has_pose; }
template <std::size_t K>
bool has_convention(const Cell& cell) {
  return is_imported(cell) && K < cell.imported->conventions;
}
bool has_innovations(const Cell& cell) { return is_filter(cell) || cell.imported->has_innovations; }

constexpr const char* kPose = "m, m, rad";
constexpr const char* kPoseSquared = "(m, m, rad)^2";

/// A column with one number without unit per scan, from the report of a filter.
ColumnKind of_report(const char* name, const char* group, Element element, const char* long_name,
                     double (*value)(const ScanReport&), bool (*applies)(const Cell&) = is_filter) {
  return {name, group, element, {Axis::scan}, "1", long_name, applies, value};
}

ColumnKind column(const char* name, const char* group, Element element, std::vector<Axis> axes,
                  const char* units, const char* long_name,
                  bool (*applies)(const Cell&) = nullptr) {
  return {name, group, element, std::move(axes), units, long_name, applies};
}

template <std::size_t K>
ColumnKind nees_by() {
  return column(kErrorConventions[K].column, "pose", Element::f64, {Axis::scan}, "1",
                kErrorConventions[K].meaning, has_convention<K>);
}
static_assert(kErrorConventions.size() == 5, "make_table() has a column of each");

// NOLINTNEXTLINE(readability-function-size): a table, a column in two lines
std::vector<ColumnKind> make_table() {
  using enum Axis;
  using enum Element;
  using Report = const ScanReport&;
  return {
      column("pose_mean", "pose", f64, {time, component}, kPose, "estimated pose", has_pose),
      column(
          "pose_covariance", "covariance", f64, {time, component, component_column}, kPoseSquared,
          "covariance of the pose: spread of the weighted particles, or the Gaussian's", has_pose),
      column("pose_mean_mixture", "covariance", f64, {time, component}, kPose,
             "mean of the Gaussian mixture before sampling", has_mixture),
      column("pose_covariance_mixture", "covariance", f64, {time, component, component_column},
             kPoseSquared, "covariance of the mixture: spread plus each particle's own",
             has_mixture),
      of_report("ess", "pose", f64, "effective sample size after weighing",
                [](Report r) { return r.ess; }),
      of_report("resampled", "pose", u8, "1 where the particles were resampled",
                [](Report r) { return r.resampled ? 1.0 : 0.0; }),
      of_report("log_likelihood", "pose", f64, "log density of the scan given the past",
                [](Report r) { return r.log_likelihood; }),
      of_report(
          "nis", "pose", f64, "normalised innovation squared of the scan",
          [](Report r) { return r.nis; }, has_innovations),
      of_report(
          "nis_dof", "pose", u32, "degrees of freedom of nis",
          [](Report r) { return static_cast<double>(r.nis_dof); }, has_innovations),
      of_report(
          "numerical_faults", "pose", u32, "factorisations answered by a fallback",
          [](Report r) { return static_cast<double>(r.numerical_faults); }, nullptr),
      column("error", "pose", f64, {scan, error_component}, "as the cell's setting units",
             "imported: error of the estimate, by the cell's setting error", has_imported_error),
      column("error_covariance", "pose", f64, {scan, error_component, error_component_column},
             "products of the cell's setting units",
             "imported: covariance of error, as the other program reported it", has_imported_error),
      nees_by<0>(),
      nees_by<1>(),
      nees_by<2>(),
      nees_by<3>(),
      nees_by<4>(),
      of_report("map_size", "pose", f64, "landmarks in the map, mean over the particles",
                [](Report r) { return r.map_size; }),
      of_report("association_correct", "association", f64,
                "detections given to their landmark, or made new where the map had none, mean over "
                "the weighted particles",
                [](Report r) { return r.association.correct; }),
      of_report("association_wrong", "association", f64,
                "detections given to another landmark, mean over the weighted particles",
                [](Report r) { return r.association.wrong; }),
      of_report(
          "association_new_again", "association", f64,
          "detections made new though the map had their landmark, mean over the weighted particles",
          [](Report r) { return r.association.new_again; }),
      of_report("association_missed", "association", f64,
                "detections of a landmark that were left out, mean over the weighted particles",
                [](Report r) { return r.association.missed; }),
      of_report("association_clutter", "association", f64,
                "false alarms given to a landmark or made new, mean over the weighted particles",
                [](Report r) { return r.association.clutter; }),
      column("ancestor", "ancestry", u16, {scan, particle}, "1",
             "index of the particle's parent one scan ago", has_particles),
      column("particle_pose", "particles", f64, {scan, particle, component}, kPose,
             "poses of the particles after drawing, before resampling", has_particles),
      column("log_weight", "particles", f64, {scan, particle}, "1",
             "normalised log weights of the particles", has_particles),
      column("map_mean", "map", f64, {scan, landmark, coordinate}, "m", "estimated landmark",
             has_map),
      column("map_covariance", "map", f64, {scan, landmark, coordinate, coordinate_column}, "m2",
             "covariance of the landmark", has_map),
      column("map_seen", "map", u8, {scan, landmark}, "1", "1 once the landmark is in the map",
             has_map),
      column("final_map_mean", "final_map", f64, {landmark, coordinate}, "m", "estimated landmark",
             has_map),
      column("final_map_covariance", "final_map", f64, {landmark, coordinate, coordinate_column},
             "m2", "covariance of the landmark", has_map),
      column("final_map_seen", "final_map", u8, {landmark}, "1",
             "1 once the landmark is in the map", has_map),
      column("joint_mean", "joint", f64, {joint, state}, "m, m, rad, m",
             "estimated pose and landmarks together", has_joint),
      column("joint_covariance", "joint", f64, {joint, state, state_column}, "(m, m, rad, m)^2",
             "covariance of the pose and all landmarks together", has_joint)};
}

}  // namespace

std::span<const ColumnGroup> column_groups() { return kGroups; }

std::span<const ColumnKind> column_table() {
  static const std::vector<ColumnKind> table = make_table();
  return table;
}

bool is_selected(std::string_view group, const ColumnSelection& selection) {
  const auto found = std::ranges::find(column_groups(), group, &ColumnGroup::name);
  expect(found != column_groups().end(), "a column of no group");
  return found->is_chosen == nullptr || selection.*(found->is_chosen);
}

ColumnSelection in_full(ColumnSelection selection) {
  selection.covariance = selection.ancestry = selection.particles = selection.map = true;
  return selection;
}

std::optional<std::size_t> length_of(Axis axis, const AxisLengths& lengths) {
  switch (axis) {
    case Axis::time:
      return lengths.time;
    case Axis::scan:
      return lengths.scan;
    case Axis::joint:
      return lengths.joint;
    case Axis::particle:
      return lengths.particle;
    case Axis::component:
    case Axis::component_column:
      return 3;
    case Axis::coordinate:
    case Axis::coordinate_column:
      return 2;
    case Axis::landmark:
      return lengths.landmark;
    case Axis::state:
    case Axis::state_column:
      if (lengths.landmark) return 3 + 2 * *lengths.landmark;
      break;
    case Axis::error_component:
    case Axis::error_component_column:
      return lengths.error_component;
  }
  return std::nullopt;
}

}  // namespace montecarta::engine
