// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/state_columns.hpp"

#include "analysis/run/nees.hpp"
#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>

namespace montecarta::experiments {
namespace {

const StateShape& pose_in_space_shape() {
  static const StateShape shape = {StateKind::pose_in_space,
                                   {"x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"},
                                   {"x", "y", "z", "rx", "ry", "rz"},
                                   {"m", "m", "m", "rad", "rad", "rad"}};
  return shape;
}

using Names = std::vector<std::string>;

/// Indices of the fields in a row of a file of estimates.
struct EstimateFields {
  StateShape shape;
  std::vector<std::size_t> state;       ///< {width} fields of the state
  std::vector<std::size_t> covariance;  ///< {d, d} fields; from a triangle, elements occur twice
  std::optional<std::size_t> nis, nis_dof;  ///< both are present or neither
};

const std::string kTimeColumn = "time_s", kCovariancePrefix = "cov_";
const Names kPoseColumns = {"x_m", "y_m", "heading_rad"};
const Names kQuaternionColumns = {"qx", "qy", "qz", "qw"};
const std::string kNis = "nis", kNisDof = "nis_dof";
constexpr std::array kKnownUnits = {"m", "rad", "mps", "mps2", "radps", "s"};
/// Columns that need a unit. Otherwise angles might be in degrees, and a heading would not be
/// wrapped.
const Names kNeedUnit = {"x", "y", "z", "heading", "yaw", "pitch", "roll", "theta", "phi", "psi"};

bool has_name(const Names& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::size_t place_of_name(const Names& names, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

void check_header(const Names& header, const std::string& place) {
  if (header.front() != kTimeColumn) {
    throw StudyError(place + ": '" + excerpt(header.front()) +
                     "' is not the first column (times come first): begin the header with time_s, "
                     "or convert the file by "
                     "experiments/convert/estimates.py");
  }
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (header[i].empty() || place_of_name(header, header[i]) != i) {
      throw StudyError(place + ": column " + std::to_string(i + 1) + " '" + excerpt(header[i]) +
                       "' has no name of its own (columns are known by their names): name each "
                       "column once");
    }
  }
}

/// Component and unit in a column name such as "vx_mps".
std::pair<std::string, std::string> component_and_unit(const std::string& column,
                                                       const std::string& place) {
  const std::size_t underscore = column.rfind('_');
  const std::string unit = underscore == std::string::npos ? "" : column.substr(underscore + 1);
  if (unit == "deg") {
    throw StudyError(place + ": '" + excerpt(column) +
                     "' is in degrees (angles are in rad): convert it and its covariance");
  }
  if (has_name(kNeedUnit, column)) {
    throw StudyError(place + ": '" + column + "' has no unit (m and rad are part of the name): " +
                     "write x_m, y_m, heading_rad");
  }
  if (std::ranges::find(kKnownUnits, unit) == kKnownUnits.end()) return {column, "1"};
  return {column.substr(0, underscore), unit};
}

bool is_same_set(Names a, Names b) {
  std::ranges::sort(a);
  std::ranges::sort(b);
  return a == b;
}

StateShape shape_of(const Names& state, const std::string& place) {
  if (state.empty()) {
    throw StudyError(place + ": no state (the header has times and covariances alone): add e.g. " +
                     joined(kPoseColumns, ","));
  }
  if (is_same_set(state, kPoseColumns)) {
    return {StateKind::pose, kPoseColumns, {"x", "y", "heading"}, {"m", "m", "rad"}};
  }
  if (is_same_set(state, pose_in_space_shape().columns)) {
    return pose_in_space_shape();
  }
  if (std::ranges::any_of(kQuaternionColumns,
                          [&](const std::string& q) { return has_name(state, q); })) {
    throw StudyError(place + ": a quaternion, but not a pose in space (nothing else has one): " +
                     "name the state " + joined(pose_in_space_shape().columns, ","));
  }
  StateShape shape{StateKind::vector, state, {}, {}};
  for (const std::string& column : state) {
    const auto [component, unit] = component_and_unit(column, place);
    const auto same = std::ranges::find(shape.components, component);
    if (same != shape.components.end()) {
      throw StudyError(
          place + ": '" + state[static_cast<std::size_t>(same - shape.components.begin())] +
          "' and '" + column + "' are both of a component " + component +
          " (units do not count, and cov_" + component + "_" + component +
          " would be of either): name them apart, e.g. " + component + "1, " + component + "2");
    }
    shape.components.push_back(component);
    shape.units.push_back(unit);
  }
  return shape;
}

/// Row and column of the covariance for every name that an element may have in the header.
std::map<std::string, std::pair<std::size_t, std::size_t>> names_of_elements(
    const StateShape& shape) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> elements;
  for (std::size_t i = 0; i < shape.dimension(); ++i) {
    for (std::size_t j = 0; j < shape.dimension(); ++j) {
      elements[kCovariancePrefix + shape.components[i] + "_" + shape.components[j]] = {i, j};
      elements[kCovariancePrefix + std::to_string(i) + "_" + std::to_string(j)] = {i, j};
    }
  }
  return elements;
}

std::vector<std::size_t> covariance_fields(const Names& header, const StateShape& shape,
                                           const std::string& place) {
  const std::size_t d = shape.dimension();
  const auto elements = names_of_elements(shape);
  std::vector<std::optional<std::size_t>> found(d * d);
  for (std::size_t f = 0; f < header.size(); ++f) {
    if (!header[f].starts_with(kCovariancePrefix)) continue;
    const auto element = elements.find(header[f]);
    if (element == elements.end()) {
      throw StudyError(place + ": '" + excerpt(header[f]) +
                       "' is no element of the covariance (its components are " +
                       joined(shape.components) + ", or indices from 0): write cov_" +
                       shape.components.front() + "_" + shape.components.back() + " or cov_0_" +
                       std::to_string(d - 1));
    }
    const auto [i, j] = element->second;
    if (found[i * d + j]) {
      throw StudyError(place + ": '" + header[f] +
                       "' is there by name and by index (which one is "
                       "it?): remove one");
    }
    found[i * d + j] = f;
  }
  std::vector<std::size_t> fields;
  for (std::size_t i = 0; i < d; ++i) {
    for (std::size_t j = 0; j < d; ++j) {
      const auto& field = found[i * d + j] ? found[i * d + j] : found[j * d + i];
      if (!field) {
        throw StudyError(place + ": no cov_" + shape.components[i] + "_" + shape.components[j] +
                         " (a verdict needs the whole covariance, or one triangle of it): add "
                         "the column");
      }
      fields.push_back(*field);
    }
  }
  return fields;
}

bool is_of_state(const std::string& name) {
  return name != kTimeColumn && name != kNis && name != kNisDof &&
         !name.starts_with(kCovariancePrefix);
}

/// Parses the header of estimates: `time_s`, the state, then `cov_A_B`, where A and B are names of
/// components or indices from 0, for the whole covariance or one triangle, and optionally `nis` and
/// `nis_dof`. Throws StudyError that begins with `place`.
EstimateFields estimate_fields(const Names& header, const std::string& place) {
  check_header(header, place);
  Names state;
  std::ranges::copy_if(header, std::back_inserter(state), is_of_state);
  EstimateFields fields{
      .shape = shape_of(state, place), .state = {}, .covariance = {}, .nis = {}, .nis_dof = {}};
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
    fields.state.push_back(place_of_name(header, column));
  fields.covariance = covariance_fields(header, fields.shape, place);
  return fields;
}

/// Parses the header of innovations: `time_s`, then either `nis` and `nis_dof`, which leave the
/// other fields empty, or the components of the innovation and their covariance as in a header of
/// estimates. Throws StudyError that begins with `place`.
EstimateFields innovation_fields(const Names& header, const std::string& place) {
  EstimateFields fields;
  if (is_same_set(header, {kTimeColumn, kNis, kNisDof})) {
    check_header(header, place);
    fields.nis = place_of_name(header, kNis);
    fields.nis_dof = place_of_name(header, kNisDof);
    return fields;
  }
  if (has_name(header, kNis) || has_name(header, kNisDof)) {
    throw StudyError(place +
                     ": nis and other columns (innovations are either): write time_s,nis,nis_dof, "
                     "or the components of the innovation and their covariance");
  }
  fields = estimate_fields(header, place);
  if (fields.shape.kind != StateKind::pose_in_space) return fields;
  throw StudyError(place + ": a quaternion is no innovation: write its components, e.g. rx_rad");
}

/// Indices of the state's fields in the header of a truth, which may have further columns. Throws
/// StudyError that begins with `place`.
std::vector<std::size_t> truth_fields(const Names& header, const StateShape& shape,
                                      const std::string& place) {
  check_header(header, place);
  std::vector<std::size_t> fields;
  for (const std::string& column : shape.columns) {
    if (!has_name(header, column)) {
      throw StudyError(place + ": no column " + column +
                       " (the truth of everything that is estimated is needed): add it, or leave "
                       "it out of the estimates");
    }
    fields.push_back(place_of_name(header, column));
  }
  return fields;
}

/// Tolerance of the length of a quaternion that was printed with three digits.
constexpr double kQuaternionPlaceSlack = 2e-3;
constexpr Eigen::Index kQuaternionPlace = 3;  // index of the quaternion, behind x, y, z

/// Normalises the quaternion at the end of the state of a pose in space.
void normalise_quaternion(Eigen::VectorXd& state, const std::string& place) {
  const double length = state.tail<4>().norm();
  if (std::abs(length - 1.0) > kQuaternionPlaceSlack) {
    throw StudyError(place + ": the quaternion has length " + to_text(length) +
                     " (of a rotation it is 1): write qx, qy, qz, qw of a unit quaternion");
  }
  state.tail<4>() /= length;
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

bool is_angle(const StateShape& shape, Eigen::Index k) {
  return shape.kind != StateKind::pose_in_space &&
         shape.units[static_cast<std::size_t>(k)] == "rad";
}

/// Interpolates from state `a` (`share` = 0) to state `b` (`share` = 1).
Eigen::VectorXd between(const StateShape& shape, const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                        double share) {
  Eigen::VectorXd state = a + share * (b - a);
  for (Eigen::Index k = 0; k < state.size(); ++k) {
    if (is_angle(shape, k)) state(k) = wrap(a(k) + share * wrap(b(k) - a(k)));
  }
  if (shape.kind == StateKind::pose_in_space) {
    const Eigen::Quaterniond from(Eigen::Vector4d(a.segment<4>(kQuaternionPlace)));
    const Eigen::Quaterniond to(Eigen::Vector4d(b.segment<4>(kQuaternionPlace)));
    state.segment<4>(kQuaternionPlace) = from.slerp(share, to).coeffs();
  }
  return state;
}

namespace fs = std::filesystem;

/// Index of the estimate to which a row of innovations belongs.
std::size_t place_in(const StateRows& rows, double time, double tolerance, const CsvRows& file,
                     const fs::path& estimates) {
  const auto after = std::ranges::lower_bound(rows.time, time);
  auto k = static_cast<std::size_t>(after - rows.time.begin());
  if (k == rows.time.size() || (k > 0 && time - rows.time[k - 1] < rows.time[k] - time)) --k;
  if (std::abs(rows.time[k] - time) <= tolerance) return k;
  file.refuse("no estimate in " + estimates.string() + " has time " + to_text(time) +
              " s (the nearest has " + to_text(rows.time[k]) +
              " s): give innovations the times of the estimates after them, or leave out "
              "innovations without an estimate");
}

/// The number of components of a NIS. Throws StudyError that begins with `place` if `nis` is not a
/// sum of squares or `dof` is not a count.
std::uint32_t checked_dof(double nis, double dof, const std::string& place) {
  constexpr double kMostComponents = 1e6;
  if (nis >= 0.0 && dof >= 0.0 && dof <= kMostComponents && dof == std::floor(dof)) {
    return static_cast<std::uint32_t>(dof);
  }
  throw StudyError(place + ": nis " + to_text(nis) + " with nis_dof " + to_text(dof) +
                   " (a sum of squares and its number of components are needed): write 0 "
                   "and 0 if nothing was observed");
}

/// The NIS of a row and its number of components.
std::pair<double, std::uint32_t> squares_of(const CsvRows& file, const EstimateFields& fields) {
  if (fields.nis) {
    const double nis = file.number(*fields.nis, "number");
    return {nis, checked_dof(nis, file.number(*fields.nis_dof, "number"), file.place())};
  }
  const analysis::Nees sample = analysis::imported_nees(state_in(file, fields.state, fields.shape),
                                                        covariance_in(file, fields));
  const auto dimension = static_cast<std::uint32_t>(fields.shape.dimension());
  return {sample.value, sample.is_usable() ? static_cast<std::uint32_t>(sample.rank) : dimension};
}

/// Counts a row of innovations if one of them is an angle beyond pi.
void count_unwrapped(const CsvRows& file, const EstimateFields& fields, StateRows& rows) {
  if (fields.nis) return;
  constexpr double kMost = kPi * (1.0 + 1e-6);  // pi itself may be printed with few digits
  for (std::size_t k = 0; k < fields.state.size(); ++k) {
    if (!is_angle(fields.shape, static_cast<Eigen::Index>(k))) continue;
    const double angle = file.number(fields.state[k], "number");
    if (std::abs(angle) <= kMost) continue;
    if (rows.unwrapped_innovations++ > 0) return;
    rows.first_unwrapped = file.place() + ": " + fields.shape.columns[k] + " " + to_text(angle);
    return;
  }
}

}  // namespace

std::string name_of(StateKind kind) {
  return kind == StateKind::pose            ? "pose"
         : kind == StateKind::pose_in_space ? "pose in space"
                                            : "vector";
}

StateRows read_estimates(const std::filesystem::path& path) {
  CsvRows file(path);
  const EstimateFields fields = estimate_fields(file.columns(), file.place());
  StateRows rows{fields.shape, {}, {}, {}, {}, {}};
  while (file.next()) {
    rows.time.push_back(file.time());
    rows.state.push_back(state_in(file, fields.state, fields.shape));
    rows.covariance.push_back(covariance_in(file, fields));
    if (!fields.nis) continue;
    const auto [nis, dof] = squares_of(file, fields);
    rows.nis.push_back(nis);
    rows.nis_dof.push_back(dof);
  }
  return rows;
}

std::size_t rows_in(const std::filesystem::path& path) {
  CsvRows file(path);
  std::size_t rows = 0;
  while (file.next()) ++rows;
  return rows;
}

StateRows read_truth(const std::filesystem::path& path, const StateShape& shape) {
  CsvRows file(path);
  const std::vector<std::size_t> fields = truth_fields(file.columns(), shape, file.place());
  StateRows rows{shape, {}, {}, {}, {}, {}};
  while (file.next()) {
    rows.time.push_back(file.time());
    rows.state.push_back(state_in(file, fields, shape));
  }
  file.require_some();
  return rows;
}

Eigen::VectorXd truth_at(const StateRows& truth, double time, const TimeMatch& match,
                         const std::filesystem::path& estimate,
                         const std::filesystem::path& truths) {
  const auto after = std::ranges::lower_bound(truth.time, time);
  const auto right = static_cast<std::size_t>(after - truth.time.begin());
  const bool has_left = right > 0, has_right = right < truth.time.size();
  const double to_left = has_left ? time - truth.time[right - 1] : INFINITY;
  const double to_right = has_right ? truth.time[right] - time : INFINITY;
  if (std::min(to_left, to_right) <= match.tolerance) {
    return truth.state[to_right <= to_left ? right : right - 1];
  }
  if (match.interpolate && has_left && has_right) {
    return between(truth.shape, truth.state[right - 1], truth.state[right],
                   to_left / (to_left + to_right));
  }
  throw StudyError(estimate.string() + ": time " + to_text(time) + " s has no truth in " +
                   truths.string() + " (the nearest is " + to_text(std::min(to_left, to_right)) +
                   " s away, --tolerance is " + to_text(match.tolerance) + " s): " +
                   (has_left && has_right
                        ? "give truths at the times of the estimates, or use --interpolate, or a "
                          "larger --tolerance if times have few digits"
                        : "leave out estimates outside of the truth, or use a larger --tolerance "
                          "if times have few digits"));
}

std::optional<fs::path> innovations_beside(const fs::path& estimates) {
  const std::string wanted = "estimate";
  std::string name = estimates.filename().string();
  const std::size_t at = name.rfind(wanted);
  if (at == std::string::npos) return std::nullopt;
  name.replace(at, wanted.size(), "innovation");
  fs::path beside = estimates.parent_path() / fs::path(name).replace_extension(".csv");
  std::error_code ignored;
  if (!fs::is_regular_file(beside, ignored)) return std::nullopt;
  return beside;
}

void read_innovations(const fs::path& path, const fs::path& estimates, double tolerance,
                      StateRows& rows) {
  if (!rows.nis.empty()) {
    throw StudyError(path.string() + ": innovations, and " + estimates.string() +
                     " has nis too (which one is it?): remove one");
  }
  CsvRows file(path);
  const EstimateFields fields = innovation_fields(file.columns(), file.place());
  std::vector<double> nis(rows.time.size());
  std::vector<std::uint32_t> dof(rows.time.size());
  while (file.next()) {
    const double time = file.time(CsvRows::Order::not_earlier);
    const auto [row_nis, row_dof] = squares_of(file, fields);
    count_unwrapped(file, fields, rows);
    if (rows.time.empty()) continue;
    const std::size_t k = place_in(rows, time, tolerance, file, estimates);
    nis[k] += row_nis;
    dof[k] += row_dof;
  }
  rows.nis = std::move(nis);
  rows.nis_dof = std::move(dof);
}

}  // namespace montecarta::experiments
