// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/angle_units.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/numbers/angle.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <vector>

namespace montecarta::experiments {
namespace {

constexpr double kDegree = kPi / 180.0;
/// [rad] Angles up to this may count a turn or two.
constexpr double kTwoTurns = 4.0 * kPi;
/// Least share of steps beyond half a turn that is no noise, and no gap in the times.
constexpr double kManySteps = 0.1;

/// One angle of a state over the rows of a file.
struct AngleColumn {
  std::string name;
  std::vector<double> value;  ///< {row}
  bool is_orientation = false;
  bool is_heading = false;
};

/// Index of the first row beyond two turns; nullopt if there is none.
std::optional<std::size_t> first_beyond(const AngleColumn& angle) {
  const auto beyond =
      std::ranges::find_if(angle.value, [](double value) { return std::abs(value) > kTwoTurns; });
  if (beyond == angle.value.end()) return std::nullopt;
  return static_cast<std::size_t>(beyond - angle.value.begin());
}

/// Mean cosine between the heading and the direction of motion, weighted by distance, if one unit
/// of the heading is `unit` [rad].
double agreement_with_motion(const StateRows& rows, const AngleColumn& heading, double unit) {
  const std::vector<std::string>& columns = rows.shape.columns;
  const auto x = std::ranges::find(columns, "x_m") - columns.begin();
  const auto y = std::ranges::find(columns, "y_m") - columns.begin();
  if (std::max(x, y) == std::ssize(columns)) return 0.0;
  double cosines = 0.0, distances = 0.0;
  for (std::size_t k = 1; k < rows.state.size(); ++k) {
    const Eigen::VectorXd step = rows.state[k] - rows.state[k - 1];
    const double middle = 0.5 * unit * (heading.value[k] + heading.value[k - 1]);
    cosines += step(x) * std::cos(middle) + step(y) * std::sin(middle);
    distances += Eigen::Vector2d(step(x), step(y)).norm();
  }
  return distances > 0.0 ? cosines / distances : 0.0;
}

bool moves_in_degrees(const StateRows& rows, const AngleColumn& heading) {
  return agreement_with_motion(rows, heading, kDegree) > 0.9 &&
         agreement_with_motion(rows, heading, 1.0) < 0.5;
}

constexpr const char* kMotionInDegrees =
    "in degrees it is the direction of motion, in rad it is not";

/// The reason why an angle beyond two turns is in degrees; empty if it may be in rad.
std::string sign_of_degrees(const StateRows& rows, const AngleColumn& angle) {
  constexpr double kLeastWrap = 330.0, kMostWrap = 360.5;
  std::size_t large = 0, wraps = 0;
  for (std::size_t k = 1; k < angle.value.size(); ++k) {
    const double step = std::abs(angle.value[k] - angle.value[k - 1]);
    large += step > kPi ? 1 : 0;
    wraps += step >= kLeastWrap && step <= kMostWrap ? 1 : 0;
  }
  const std::size_t steps = angle.value.size() - 1;
  if (large > 0 && static_cast<double>(large) >= kManySteps * static_cast<double>(steps)) {
    return formatted("{} of {} steps from row to row are beyond pi", large, steps);
  }
  if (wraps > 0) return "it steps by nearly 360 where degrees begin again";
  return angle.is_heading && moves_in_degrees(rows, angle) ? kMotionInDegrees : "";
}

std::vector<AngleColumn> angles_of(const StateRows& rows) {
  constexpr std::array kOrientation = {"heading", "yaw", "pitch", "roll", "theta", "phi", "psi"};
  std::vector<AngleColumn> angles;
  for (std::size_t k = 0; k < rows.shape.width(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (!is_angle(rows.shape, i)) continue;
    AngleColumn& angle = angles.emplace_back();
    angle.name = rows.shape.columns[k];
    angle.is_orientation = std::ranges::count(kOrientation, rows.shape.components[k]) > 0;
    angle.is_heading =
        angle.is_orientation && angle.name != "pitch_rad" && angle.name != "roll_rad";
    for (const Eigen::VectorXd& state : rows.state) angle.value.push_back(state(i));
  }
  return angles;
}

std::string place_in(const StateRows& rows, const std::filesystem::path& path, std::size_t row) {
  return formatted("{}:{}", path, rows.line[row]);
}

/// A note on a heading beyond half a turn that is the direction of motion in degrees only.
std::string note_on_heading(const StateRows& rows, const AngleColumn& heading,
                            const std::filesystem::path& path) {
  const auto beyond =
      std::ranges::find_if(heading.value, [](double value) { return std::abs(value) > kPi; });
  if (!heading.is_heading || beyond == heading.value.end() || !moves_in_degrees(rows, heading))
    return "";
  const auto row = static_cast<std::size_t>(beyond - heading.value.begin());
  return formatted("{}: {} {} (it is judged as rad; {}): is it in degrees?",
                   place_in(rows, path, row), heading.name, to_text(*beyond), kMotionInDegrees);
}

}  // namespace

void require_radians(const StateRows& rows, const std::filesystem::path& path) {
  for (const AngleColumn& angle : angles_of(rows)) {
    const auto beyond = first_beyond(angle);
    if (!beyond || !angle.is_orientation) continue;
    const std::string sign = sign_of_degrees(rows, angle);
    if (sign.empty()) continue;
    throw StudyError(
        "{}: {} {} is in degrees ({}): convert it to rad (degrees times pi / 180), and its "
        "covariance too if that is in degrees",
        place_in(rows, path, *beyond), angle.name, to_text(angle.value[*beyond]), sign);
  }
}

std::string note_on_angles(const StateRows& rows, const std::filesystem::path& path) {
  for (const AngleColumn& angle : angles_of(rows)) {
    if (std::string note = note_on_heading(rows, angle, path); !note.empty()) return note;
    const auto beyond = first_beyond(angle);
    if (!beyond) continue;
    const bool begins_there = *beyond == 0 && angle.is_orientation;
    if (!begins_there && (angle.is_orientation || sign_of_degrees(rows, angle).empty())) continue;
    return formatted("{}: {} {} (more than two turns; it is judged as rad): is it in degrees?",
                     place_in(rows, path, *beyond), angle.name, to_text(angle.value[*beyond]));
  }
  return "";
}

}  // namespace montecarta::experiments
