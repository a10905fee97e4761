// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/state_columns.hpp"

#include "analysis/run/nees.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/judging/column_names.hpp"
#include "experiments/judging/covariance_columns.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace montecarta::experiments {
namespace {

const StateShape& pose_in_space_shape() {
  static const StateShape shape = {StateKind::pose_in_space,
                                   {"x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"},
                                   {"x", "y", "z", "rx", "ry", "rz"},
                                   {"m", "m", "m", "rad", "rad", "rad"}};
  return shape;
}

/// The velocity beside a pose in space.
const Names kVelocityColumns = {"vx_mps", "vy_mps", "vz_mps"};
const std::string kHeadingColumn = kPoseColumns.back();
const Names kQuaternionColumns = {"qx", "qy", "qz", "qw"};

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
  if (to_number(header.front())) {
    throw StudyError(
        "{}: '{}' is a number, where a header with the names of the columns is "
        "expected (a line that begins with # is a comment, so that names behind it are not read): "
        "begin the header with time_s, without #, or convert the file by "
        "experiments/convert/estimates.py",
        place, excerpt(header.front()));
  }
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
    throw StudyError(
        "{}: no state (the header has times, innovations and covariances alone): add e.g. {}, or "
        "judge innovations alone by --innovations",
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

/// Number of columns of a state that are the truth of another.
std::size_t columns_of_truth(const Names& header) {
  return static_cast<std::size_t>(std::ranges::count_if(header, [&](const std::string& name) {
    const bool is_covariance =
        name.starts_with(kTruthPrefix + kCovariancePrefix) ||
        (name.starts_with(kTruthPrefix) && is_deviation(name.substr(kTruthPrefix.size()), header));
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
  find_covariance(header, place, fields);
  return fields;
}

EstimateFields estimate_fields(const Names& header, const std::string& place) {
  if (!has_name(header, kSensor)) return fields_of(header, place);
  throw StudyError(
      "{}: '{}' names the sensor of an innovation (this file has estimates): give innovations in a "
      "file of their own",
      place, kSensor);
}

/// Throws StudyError if the column of sensors has another name.
void refuse_other_sensor(const Names& header, const std::string& place) {
  for (const std::string& name : header) {
    std::string small = name;
    std::ranges::transform(small, small.begin(), [](unsigned char c) { return std::tolower(c); });
    const bool is_meant = has_name({kSensor, "sensors", "sensor_name", "sensor_id"}, small);
    if (!is_meant || name == kSensor) continue;
    throw StudyError("{}: '{}' is not the name of the column of sensors: rename it to {}", place,
                     excerpt(name), kSensor);
  }
}

EstimateFields innovation_fields(const Names& header, const std::string& place) {
  refuse_other_sensor(header, place);
  EstimateFields fields;
  Names numbers = header;
  std::erase(numbers, kSensor);
  if (is_same_set(numbers, {kTimeColumn, kNis, kNisDof})) {
    check_header(header, place);
    fields.nis = place_of_name(header, kNis);
    fields.nis_dof = place_of_name(header, kNisDof);
  } else if (has_name(header, kNis) || has_name(header, kNisDof)) {
    std::erase_if(numbers, [](const auto& name) {
      return name == kTimeColumn || name == kNis || name == kNisDof;
    });
    throw StudyError(
        "{}: {},{} {} (innovations have a size, or components and their covariance): write "
        "time_s,nis,nis_dof, or leave them out",
        place, kNis, kNisDof,
        numbers.empty() ? "are not both there" : "beside " + joined(numbers, ","));
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
  if (with_covariance) find_covariance_of_truth(columns, place, prefix, fields);
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
      const std::size_t field = fields.covariance[static_cast<std::size_t>(i * d + j)];
      P(i, j) = field == EstimateFields::kNoField ? 0.0 : rows.number(field, "number");
      if (fields.are_deviations) P(i, j) *= std::abs(P(i, j));  // a sign that is wrong stays
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
