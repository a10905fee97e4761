// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/column_names.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace montecarta::experiments {
namespace {

constexpr std::array kKnownUnits = {"m", "rad", "mps", "mps2", "radps", "s"};
/// Columns that need a unit. Otherwise angles might be in degrees, and a heading would not be
/// wrapped.
const Names kNeedUnit = {"x", "y", "z", "heading", "yaw", "pitch", "roll", "theta", "phi", "psi"};

bool is_of_state(const std::string& name) {
  return name != kTimeColumn && name != kNis && name != kNisDof && name != kSensor &&
         !name.starts_with(kCovariancePrefix);
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

}  // namespace

bool has_name(const Names& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::string without_unit(const std::string& name) {
  const std::size_t underscore = name.rfind('_');
  if (underscore == std::string::npos) return name;
  const bool has_unit =
      std::ranges::find(kKnownUnits, name.substr(underscore + 1)) != kKnownUnits.end();
  return has_unit ? name.substr(0, underscore) : name;
}

bool is_deviation(const std::string& name, const Names& header) {
  if (!name.starts_with(kSigmaPrefix)) return false;
  const std::string of = without_unit(name.substr(kSigmaPrefix.size()));
  if (has_name({"rx", "ry", "rz"}, of) && has_name(header, "qw")) return true;
  return std::ranges::any_of(header, [&](const std::string& column) {
    const bool is_error = column.starts_with(kErrorPrefix);
    return without_unit(is_error ? column.substr(kErrorPrefix.size()) : column) == of;
  });
}

Names state_in_header(const Names& header) {
  Names state;
  std::ranges::copy_if(header, std::back_inserter(state), [&](const std::string& name) {
    const bool is_of_truth =
        name.starts_with(kTruthPrefix) && has_name(header, name.substr(kTruthPrefix.size()));
    const bool is_of_its_error =
        name.starts_with(kTruthPrefix) && is_deviation(name.substr(kTruthPrefix.size()), header);
    return is_of_state(name) && !is_of_truth && !is_of_its_error && !is_deviation(name, header);
  });
  return state;
}

std::size_t place_of_name(const Names& names, const std::string& name) {
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

std::string heading_in(const Names& columns) {
  if (has_name(columns, kPoseColumns.back())) return kPoseColumns.back();
  std::string found;
  for (const std::string& name : kOtherHeadings) {
    if (!has_name(columns, name + "_rad")) continue;
    if (!found.empty()) return "";
    found = name + "_rad";
  }
  return found;
}

Names usual_names(Names state) {
  const std::string heading = heading_in(state);
  if (state.size() == kPoseColumns.size() && !heading.empty()) {
    std::ranges::replace(state, heading, kPoseColumns.back());
  }
  return state;
}

std::size_t place_of_column(const Names& header, const std::string& column, StateKind kind) {
  const bool is_heading = kind == StateKind::pose && column == kPoseColumns.back();
  return place_of_name(header, is_heading ? heading_in(header) : column);
}

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

}  // namespace montecarta::experiments
