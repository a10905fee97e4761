// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/state_columns.hpp"

#include "analysis/run/nees.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace montecarta::experiments {
namespace {

using Names = std::vector<std::string>;

const StateShape& pose_in_space_shape() {
  static const StateShape shape = {StateKind::pose_in_space,
                                   {"x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"},
                                   {"x", "y", "z", "rx", "ry", "rz"},
                                   {"m", "m", "m", "rad", "rad", "rad"}};
  return shape;
}

/// The velocity beside a pose in space.
const Names kVelocityColumns = {"vx_mps", "vy_mps", "vz_mps"};
const std::string kCovariancePrefix = "cov_";
const Names kPoseColumns = {"x_m", "y_m", "heading_rad"};
/// Other names of the heading, each followed by _rad.
const Names kOtherHeadings = {"yaw", "theta", "psi", "phi"};
const std::string kHeadingColumn = kPoseColumns.back();
const Names kQuaternionColumns = {"qx", "qy", "qz", "qw"};
const std::string kNis = "nis", kNisDof = "nis_dof", kSensor = "sensor";
constexpr std::array kKnownUnits = {"m", "rad", "mps", "mps2", "radps", "s"};
/// Columns that need a unit. Otherwise angles might be in degrees, and a heading would not be
/// wrapped.
const Names kNeedUnit = {"x", "y", "z", "heading", "yaw", "pitch", "roll", "theta", "phi", "psi"};

bool is_of_state(const std::string& name) {
  return name != kTimeColumn && name != kNis && name != kNisDof && name != kSensor &&
         !name.starts_with(kCovariancePrefix);
}

bool has_name(const Names& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// The names of the state in a header, without those of a truth beside it.
Names state_in_header(const Names& header) {
  Names state;
  std::ranges::copy_if(header, std::back_inserter(state), [&](const std::string& name) {
    const bool is_of_truth =
        name.starts_with(kTruthPrefix) && has_name(header, name.substr(kTruthPrefix.size()));
    return is_of_state(name) && !is_of_truth;
  });
  return state;
}

std::size_t place_of_name(const Names& names, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

/// The heading in the names of columns: heading_rad, or another name of it. Empty if there is none,
/// or if there are several other names.
std::string heading_in(const Names& columns) {
  if (has_name(columns, kHeadingColumn)) return kHeadingColumn;
  std::string found;
  for (const std::string& name : kOtherHeadings) {
    if (!has_name(columns, name + "_rad")) continue;
    if (!found.empty()) return "";
    found = name + "_rad";
  }
  return found;
}

/// The names of a state, where another name of the heading of a pose is replaced by its usual one.
Names usual_names(Names state) {
  const std::string heading = heading_in(state);
  if (state.size() == kPoseColumns.size() && !heading.empty()) {
    std::ranges::replace(state, heading, kHeadingColumn);
  }
  return state;
}

/// Index in a header of a column of a state of this kind; the size of the header if it has none.
std::size_t place_of_column(const Names& header, const std::string& column, StateKind kind) {
  const bool is_heading = kind == StateKind::pose && column == kHeadingColumn;
  return place_of_name(header, is_heading ? heading_in(header) : column);
}

/// Throws StudyError if the first column is a time under another name.
void refuse_other_time(const std::string& column, const std::string& place) {
  const std::string unit = column.substr(std::min(column.rfind('_') + 1, column.size()));
  const std::map<std::string, std::string> factors = {{"ns", "1e9"}, {"us", "1e6"}, {"ms", "1e3"}};
  const auto factor = factors.find(unit);
  if (factor != factors.end() && (column.starts_with("time") || column.starts_with("t_"))) {
    throw StudyError("{}: '{}' is in {} (times are in s): divide it by {}, and name it time_s",
                     place, excerpt(column), unit, factor->second);
  }
  const Names others = {"t",        "t_s",       "time",        "times",
                        "time_sec", "timestamp", "timestamp_s", "stamp"};
  if (has_name(others, column)) {
    throw StudyError("{}: '{}' is not the name of times (they are in s): name the column time_s",
                     place, column);
  }
}

void check_header(const Names& header, const std::string& place) {
  refuse_other_time(header.front(), place);
  if (header.front() != kTimeColumn) {
    throw StudyError(
        "{}: '{}' is not the first column (times come first): begin the header with time_s, or "
        "convert the file by experiments/convert/estimates.py",
        place, excerpt(header.front()));
  }
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (header[i].empty() || place_of_name(header, header[i]) != i) {
      throw StudyError(
          "{}: column {} '{}' has no name of its own (columns are known by their names): name each "
          "column once",
          place, i + 1, excerpt(header[i]));
    }
  }
}

/// Throws StudyError if a column ends with the name of a unit that is not read.
void refuse_other_units(const std::string& column, const std::string& component,
                        const std::string& unit, const std::string& place) {
  const Names degrees = {"deg", "degs", "degree", "degrees"}, radians = {"radian", "radians"},
              metres = {"meter", "meters", "metre", "metres"}, lengths = {"mm", "cm", "km", "ft"};
  if (has_name(degrees, unit)) {
    throw StudyError("{}: '{}' is in degrees (angles are in rad): convert it and its covariance",
                     place, excerpt(column));
  }
  const bool is_radians = has_name(radians, unit);
  if (is_radians || has_name(metres, unit)) {
    throw StudyError("{}: '{}' has a unit that is not read (rad and m are): rename it to {}{}",
                     place, excerpt(column), component, is_radians ? "_rad" : "_m");
  }
  if (has_name(lengths, unit) && has_name(kNeedUnit, component)) {
    throw StudyError("{}: '{}' is in {} (positions are in m): convert it and its covariance", place,
                     excerpt(column), unit);
  }
}

/// Component and unit in a column name such as "vx_mps".
std::pair<std::string, std::string> component_and_unit(const std::string& column,
                                                       const std::string& place) {
  const std::size_t underscore = column.rfind('_');
  const std::string unit = underscore == std::string::npos ? "" : column.substr(underscore + 1);
  refuse_other_units(column, column.substr(0, underscore), unit, place);
  if (has_name(kNeedUnit, column)) {
    throw StudyError(
        "{}: '{}' has no unit (m and rad are part of the name): write x_m, y_m, heading_rad", place,
        column);
  }
  if (std::ranges::find(kKnownUnits, unit) == kKnownUnits.end()) return {column, "1"};
  return {column.substr(0, underscore), unit};
}

bool is_same_set(Names a, Names b) {
  std::ranges::sort(a);
  std::ranges::sort(b);
  return a == b;
}

bool has_all(const Names& state, const Names& columns) {
  return std::ranges::all_of(columns, [&](const auto& name) { return has_name(state, name); });
}

/// Adds columns with their components and units to a state. Throws StudyError if a component is
/// there already.
void add_components(const Names& columns, const std::string& place, StateShape& shape) {
  for (const std::string& column : columns) {
    const auto [component, unit] = component_and_unit(column, place);
    if (const std::size_t same = place_of_name(shape.components, component);
        same < shape.components.size()) {
      const std::size_t behind = shape.columns.size() - shape.components.size();
      throw StudyError(
          "{}: '{}' and '{}' are both of a component {} (units do not count, and cov_{}_{} would "
          "be of either): name them apart, e.g. {}1, {}2",
          place, shape.columns[same + behind], column, component, component, component, component,
          component);
    }
    shape.columns.push_back(column);
    shape.components.push_back(component);
    shape.units.push_back(unit);
  }
}

/// A pose in space, then its velocity, if all of it is there, and then the other columns.
StateShape shape_with_pose_in_space(const Names& state, const std::string& place) {
  StateShape shape = pose_in_space_shape();
  Names others = has_all(state, kVelocityColumns) ? kVelocityColumns : Names();
  for (const std::string& column : state) {
    if (!has_name(shape.columns, column) && !has_name(others, column)) others.push_back(column);
  }
  add_components(others, place, shape);
  return shape;
}

/// Errors, whose columns are called error_C: a vector with the components of the state.
StateShape shape_of_errors(const Names& state, const std::string& place) {
  Names columns;
  for (const std::string& column : state) columns.push_back(column.substr(kErrorPrefix.size()));
  StateShape shape;
  add_components(columns, place, shape);
  shape.columns = state;
  return shape;
}

StateShape shape_of(const Names& state, const std::string& place) {
  if (state.empty()) {
    throw StudyError("{}: no state (the header has times and covariances alone): add e.g. {}",
                     place, joined(kPoseColumns, ","));
  }
  if (is_same_set(usual_names(state), kPoseColumns)) {
    return {StateKind::pose, kPoseColumns, {"x", "y", "heading"}, {"m", "m", "rad"}};
  }
  if (has_all(state, pose_in_space_shape().columns)) return shape_with_pose_in_space(state, place);
  if (std::ranges::any_of(kQuaternionColumns,
                          [&](const std::string& q) { return has_name(state, q); })) {
    throw StudyError(
        "{}: a quaternion, but not a pose in space (nothing else has one): name the pose {}, which "
        "other columns may follow",
        place, joined(pose_in_space_shape().columns, ","));
  }
  StateShape shape;
  add_components(state, place, shape);
  return shape;
}

/// Row and column of the covariance for every name that an element may have in the header.
std::map<std::string, std::pair<std::size_t, std::size_t>> names_of_elements(
    const Names& header, const StateShape& shape) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> elements;
  const auto add = [&](const Names& components) {
    for (std::size_t i = 0; i < components.size(); ++i) {
      for (std::size_t j = 0; j < components.size(); ++j) {
        elements[formatted("{}{}_{}", kCovariancePrefix, components[i], components[j])] = {i, j};
      }
    }
  };
  Names indices, own = shape.components;
  for (std::size_t i = 0; i < own.size(); ++i) indices.push_back(std::to_string(i));
  add(indices);
  add(own);
  if (shape.kind == StateKind::pose) {
    const std::string heading = heading_in(header);
    own.back() = heading.substr(0, heading.rfind('_'));
    add(own);
  }
  return elements;
}

/// Throws StudyError if an element of the covariance has indices, but a state of more than a pose
/// in space has its columns in another order than that of its components.
void refuse_indices_out_of_order(const Names& header, std::size_t field, const StateShape& shape,
                                 const std::string& place) {
  const bool has_index = header[field].find_first_of("0123456789", kCovariancePrefix.size()) ==
                         kCovariancePrefix.size();
  if (!has_index || shape.kind != StateKind::pose_in_space ||
      shape.dimension() == static_cast<std::size_t>(kPoseComponents)) {
    return;
  }
  if (state_in_header(header) == shape.columns) return;
  throw StudyError(
      "{}: '{}' has indices, but the state has not the order {} (so a component has no certain "
      "number): write the names of components, or the columns in the order {}",
      place, header[field], joined(shape.components, ","), joined(shape.columns, ","));
}

std::vector<std::size_t> covariance_fields(const Names& header, const StateShape& shape,
                                           const std::string& place) {
  const std::size_t d = shape.dimension();
  const auto elements = names_of_elements(header, shape);
  std::vector<std::optional<std::size_t>> found(d * d);
  for (std::size_t f = 0; f < header.size(); ++f) {
    if (!header[f].starts_with(kCovariancePrefix)) continue;
    const auto element = elements.find(header[f]);
    if (element == elements.end()) {
      throw StudyError(
          "{}: '{}' is no element of the covariance (its components are {}, or indices from 0): "
          "write cov_{}_{} or cov_0_{}",
          place, excerpt(header[f]), joined(shape.components), shape.components.front(),
          shape.components.back(), d - 1);
    }
    refuse_indices_out_of_order(header, f, shape, place);
    const auto [i, j] = element->second;
    if (found[i * d + j]) {
      throw StudyError("{}: '{}' is there by name and by index (which one is it?): remove one",
                       place, header[f]);
    }
    found[i * d + j] = f;
  }
  std::vector<std::size_t> fields;
  for (std::size_t i = 0; i < d; ++i) {
    for (std::size_t j = 0; j < d; ++j) {
      const auto& field = found[i * d + j] ? found[i * d + j] : found[j * d + i];
      if (!field) {
        throw StudyError(
            "{}: no cov_{}_{} (a verdict needs the whole covariance, or one triangle of it): add "
            "the column",
            place, shape.components[i], shape.components[j]);
      }
      fields.push_back(*field);
    }
  }
  return fields;
}

/// The fields of the covariance of a truth, which may have further elements. `columns` are without
/// the prefix.
std::vector<std::size_t> covariance_of_truth(Names columns, const StateShape& shape,
                                             const std::string& place, const std::string& prefix) {
  const bool is_in_order = usual_names(state_in_header(columns)) == shape.columns;
  const auto elements = names_of_elements(columns, shape);
  for (std::string& name : columns) {
    if (!name.starts_with(kCovariancePrefix)) continue;
    const bool has_index = name.find_first_of("0123456789") == kCovariancePrefix.size();
    if (has_index && !is_in_order) {
      throw StudyError(
          "{}: '{}{}' has indices, but the truth has not the columns of the estimates in their "
          "order (so a component has no certain number): write names, e.g. {}{}{}_{}",
          place, prefix, name, prefix, kCovariancePrefix, shape.components.front(),
          shape.components.front());
    }
    if (!elements.contains(name)) name.clear();  // of what is not estimated
  }
  return covariance_fields(
      columns, shape,
      formatted("{} (covariance of the truth{})", place,
                prefix.empty() ? "" : formatted(", in columns {}cov_A_B", prefix)));
}

/// Number of columns of a state that are the truth of another.
std::size_t columns_of_truth(const Names& header) {
  return static_cast<std::size_t>(std::ranges::count_if(header, [&](const std::string& name) {
    const bool is_covariance = name.starts_with(kTruthPrefix + kCovariancePrefix);
    return name.starts_with(kTruthPrefix) && !is_covariance;
  }));
}

/// Tolerance of the length of a quaternion that was printed with three digits.
constexpr double kQuaternionPlaceSlack = 2e-3;

}  // namespace

Eigen::Quaterniond quaternion_in(const Eigen::VectorXd& state) {
  return Eigen::Quaterniond(Eigen::Vector4d(state.segment<4>(kQuaternionPlace)));
}

void normalise_quaternion(Eigen::VectorXd& state, const std::string& place) {
  auto quaternion = state.segment<4>(kQuaternionPlace);
  const double length = quaternion.norm();
  if (std::abs(length - 1.0) > kQuaternionPlaceSlack) {
    throw StudyError(
        "{}: the quaternion has length {} (of a rotation it is 1): write qx, qy, qz, qw of a unit "
        "quaternion",
        place, to_text(length));
  }
  quaternion /= length;
}

std::uint32_t checked_dof(double nis, double dof, const std::string& place) {
  constexpr double kMostComponents = 1e6;
  if (nis >= 0.0 && dof >= 0.0 && dof <= kMostComponents && dof == std::floor(dof)) {
    return static_cast<std::uint32_t>(dof);
  }
  throw StudyError(
      "{}: nis {} with nis_dof {} (a sum of squares and its number of components are needed): "
      "write 0 and 0 if nothing was observed",
      place, to_text(nis), to_text(dof));
}

std::string name_of(StateKind kind) {
  return kind == StateKind::pose            ? "pose"
         : kind == StateKind::pose_in_space ? "pose in space"
                                            : "vector";
}

OwnTruth own_truth_in(const Names& header, const std::string& place) {
  const Names state = state_in_header(header);
  if (state.empty()) return OwnTruth::none;
  if (std::ranges::all_of(state, [](const auto& c) { return c.starts_with(kErrorPrefix); }))
    return OwnTruth::errors;
  Names without;
  std::ranges::copy_if(state, std::back_inserter(without), [&](const auto& column) {
    return !has_name(header, kTruthPrefix + column) && !column.starts_with(kTruthPrefix);
  });
  const bool has_some = std::ranges::any_of(
      header, [](const auto& column) { return column.starts_with(kTruthPrefix); });
  const bool has_errors = std::ranges::any_of(
      state, [](const auto& column) { return column.starts_with(kErrorPrefix); });
  if (has_some && (!without.empty() || state.size() != columns_of_truth(header))) {
    throw StudyError(
        "{}: some columns begin with {} (the truth of everything that is estimated is needed): the "
        "state is {}, so name each of them {}NAME too",
        place, kTruthPrefix, joined(state, ","), kTruthPrefix);
  }
  if (has_errors) {
    throw StudyError(
        "{}: some columns begin with {}, and others do not (errors need no states beside them): "
        "give the errors of all, or of none",
        place, kErrorPrefix);
  }
  return has_some ? OwnTruth::columns : OwnTruth::none;
}

EstimateFields fields_of(const Names& header, const std::string& place) {
  check_header(header, place);
  const Names state = state_in_header(header);
  EstimateFields fields{.shape = own_truth_in(header, place) == OwnTruth::errors
                                     ? shape_of_errors(state, place)
                                     : shape_of(state, place),
                        .state = {},
                        .covariance = {},
                        .nis = {},
                        .nis_dof = {}};
  if (has_name(header, kNis) != has_name(header, kNisDof)) {
    throw StudyError(place +
                     ": nis and nis_dof belong together (neither is of use without the "
                     "other): add the other one");
  }
  if (has_name(header, kNis)) {
    fields.nis = place_of_name(header, kNis);
    fields.nis_dof = place_of_name(header, kNisDof);
  }
  for (const std::string& column : fields.shape.columns)
    fields.state.push_back(place_of_column(header, column, fields.shape.kind));
  fields.covariance = covariance_fields(header, fields.shape, place);
  return fields;
}

EstimateFields estimate_fields(const Names& header, const std::string& place) {
  if (!has_name(header, kSensor)) return fields_of(header, place);
  throw StudyError(
      "{}: '{}' names the sensor of an innovation (this file has estimates): give innovations in a "
      "file of their own",
      place, kSensor);
}

EstimateFields innovation_fields(const Names& header, const std::string& place) {
  EstimateFields fields;
  Names numbers = header;
  std::erase(numbers, kSensor);
  if (is_same_set(numbers, {kTimeColumn, kNis, kNisDof})) {
    check_header(header, place);
    fields.nis = place_of_name(header, kNis);
    fields.nis_dof = place_of_name(header, kNisDof);
  } else if (has_name(header, kNis) || has_name(header, kNisDof)) {
    throw StudyError(place +
                     ": nis and other columns (innovations are either): write time_s,nis,nis_dof, "
                     "or the components of the innovation and their covariance");
  } else {
    fields = fields_of(header, place);
  }
  if (has_name(header, kSensor)) fields.sensor = place_of_name(header, kSensor);
  if (fields.shape.kind != StateKind::pose_in_space) return fields;
  throw StudyError(place + ": a quaternion is no innovation: write its components, e.g. rx_rad");
}

EstimateFields truth_fields(const Names& header, const StateShape& shape, const std::string& place,
                            const std::string& prefix, bool with_covariance) {
  check_header(header, place);
  EstimateFields fields{.shape = shape, .state = {}, .covariance = {}, .nis = {}, .nis_dof = {}};
  Names columns = header;
  for (std::string& name : columns) {
    name = name.starts_with(prefix) ? name.substr(prefix.size()) : std::string();
  }
  for (const std::string& column : shape.columns) {
    fields.state.push_back(place_of_column(columns, column, shape.kind));
    if (fields.state.back() == header.size()) {
      throw StudyError(
          "{}: no column {}{} (the truth of everything that is estimated is needed): add it, or "
          "leave it out of the estimates",
          place, prefix, column);
    }
  }
  if (with_covariance) fields.covariance = covariance_of_truth(columns, shape, place, prefix);
  return fields;
}

Eigen::VectorXd state_in(const CsvRows& rows, const std::vector<std::size_t>& fields,
                         const StateShape& shape) {
  Eigen::VectorXd state(static_cast<Eigen::Index>(fields.size()));
  for (std::size_t k = 0; k < fields.size(); ++k) {
    state(static_cast<Eigen::Index>(k)) = rows.number(fields[k], "number");
  }
  if (shape.kind == StateKind::pose_in_space) normalise_quaternion(state, rows.place());
  return state;
}

Eigen::MatrixXd covariance_in(const CsvRows& rows, const EstimateFields& fields) {
  const auto d = static_cast<Eigen::Index>(fields.shape.dimension());
  Eigen::MatrixXd P(d, d);
  for (Eigen::Index i = 0; i < d; ++i) {
    for (Eigen::Index j = 0; j < d; ++j) {
      P(i, j) = rows.number(fields.covariance[static_cast<std::size_t>(i * d + j)], "number");
    }
  }
  return P;
}

std::pair<double, std::uint32_t> nis_in(const CsvRows& file, const EstimateFields& fields) {
  if (fields.nis) {
    const double nis = file.number(*fields.nis, "number");
    return {nis, checked_dof(nis, file.number(*fields.nis_dof, "number"), file.place())};
  }
  const analysis::Nees sample = analysis::imported_nees(state_in(file, fields.state, fields.shape),
                                                        covariance_in(file, fields));
  const auto dimension = static_cast<std::uint32_t>(fields.shape.dimension());
  return {sample.value, sample.is_usable() ? static_cast<std::uint32_t>(sample.rank) : dimension};
}

std::string likeness_to_pose(const StateShape& shape) {
  if (shape.kind != StateKind::vector || !has_name(shape.columns, kPoseColumns[0]) ||
      !has_name(shape.columns, kPoseColumns[1])) {
    return "";
  }
  Names angles;
  for (const std::string& column : shape.columns) {
    if (column.ends_with("_rad")) angles.push_back(column);
  }
  if (angles.empty()) return "";
  const std::string columns = formatted("it has {}, and a pose is ", joined(shape.columns, ","));
  if (angles.size() > 1 || shape.width() > kPoseColumns.size()) {
    return formatted("{}{} alone", columns, joined(kPoseColumns, ","));
  }
  return formatted("{}{}: if it is a pose, rename {} to {}", columns, joined(kPoseColumns, ","),
                   angles.front(), kHeadingColumn);
}

bool is_angle(const StateShape& shape, Eigen::Index k) {
  const bool is_in_space = shape.kind == StateKind::pose_in_space;
  if (!shape.wraps || (is_in_space && k < kPoseWidth)) return false;
  const Eigen::Index component = is_in_space ? k - kPoseWidth + kPoseComponents : k;
  return shape.units[static_cast<std::size_t>(component)] == "rad";
}

bool has_velocity(const StateShape& shape) {
  return shape.kind == StateKind::pose_in_space && has_all(shape.columns, kVelocityColumns);
}

}  // namespace montecarta::experiments
