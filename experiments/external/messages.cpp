// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/messages.hpp"

#include "engine/formatted.hpp"
#include "experiments/external/child_process.hpp"
#include "experiments/text/words.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>

namespace montecarta::experiments {
namespace {

/// Members keep the order in which they are added.
using Json = nlohmann::ordered_json;

Json json_message(std::uint64_t id, const char* type) { return {{"id", id}, {"type", type}}; }

Json controls_of_step(std::span<const ControlRow> controls) {
  Json array = Json::array();
  for (const ControlRow& control : controls) array.push_back(control);
  return array;
}

void add_controls(const Vehicle& vehicle, const ControlNoise& noise, Json& settings) {
  Json& names = settings["controls"] = Json::array();
  std::size_t i = 0;
  for (const Quantity quantity : controls_of(vehicle)) {
    const Component& control = component_of(quantity);
    names.push_back(control.name);
    settings[si_name(control.sigma.key)] = noise.sigma[i++];
  }
  const IncrementNoise& increment = noise.increment;
  for (std::size_t k = 0; k < 3 && increment.model == IncrementModel::additive; ++k)
    settings[si_name(kIncrementKeys[k])] = increment.sigma[k];
  for (std::size_t k = 0; k < 4 && increment.model == IncrementModel::odometry; ++k)
    settings[odometry_key(k)] = increment.alpha[k];
  if (!noise.grows()) return;
  for (std::size_t k = 0; k < noise.alpha.size(); ++k) settings[alpha_key(k)] = noise.alpha[k];
}

void add_sensor(const Belief& belief, Json& settings) {
  const auto& [forward, left, turn] = belief.sensor.mounting;
  settings["sensor"] = name_of(belief.sensor);
  for (const Quantity quantity : components_of(belief.sensor)) {
    settings[si_name(component_of(quantity).sigma.key)] = deviation_of(quantity, belief);
  }
  if (belief.sensor.mounting.is_none()) return;
  settings["mount_forward"] = forward;
  settings["mount_left"] = left;
  settings["mount_turn"] = turn;
}

Json settings_of(const FilterSetup& setup) {
  const Vehicle& vehicle = setup.belief.vehicle;
  Json settings = {{"vehicle", name_of(vehicle)}};
  for_each_setting(vehicle,
                   [&](const std::string& name, const auto& value) { settings[name] = value; });
  add_controls(vehicle, setup.belief.control, settings);
  add_sensor(setup.belief, settings);
  settings["association"] = setup.association.kind == Association::known ? "known" : "nearest";
  settings["gate"] = setup.association.gate;
  settings["new_gate"] = setup.association.new_gate;
  settings["landmarks"] = setup.landmarks;
  return settings;
}

}  // namespace

std::string start_message(std::uint64_t id, const RunStart& start, const FilterSetup& setup) {
  Json message = json_message(id, "start");
  message["run"] = start.run;
  message["seed"] = start.seed;
  message["start"] = {start.pose.x, start.pose.y, start.pose.heading};
  message["settings"] = settings_of(setup);
  return message.dump();
}

std::string predict_message(std::uint64_t id, std::span<const ControlRow> controls) {
  Json message = json_message(id, "predict");
  message["controls"] = controls_of_step(controls);
  return message.dump();
}

std::string scan_message(std::uint64_t id, std::span<const ControlRow> controls, Scan scan,
                         Association association, std::size_t components) {
  Json message = json_message(id, "scan");
  message["controls"] = controls_of_step(controls);
  Json& detections = message["detections"] = Json::array();
  for (const Detection& detection : scan) {
    const bool named = association == Association::known && detection.identity >= 0;
    Json numbers = Json::array();
    for (std::size_t i = 0; i < components; ++i) numbers.push_back(detection[i]);
    numbers.push_back(named ? detection.identity : -1);
    detections.push_back(std::move(numbers));
  }
  return message.dump();
}

std::string map_message(std::uint64_t id) { return json_message(id, "map").dump(); }

namespace {

/// A parsed answer. Members are found by name in logarithmic time, since there may be very many.
using Answer = nlohmann::json;

constexpr int kDeepest = 4;  // deepest nesting of brackets in a valid answer
/// Bound on the rounding error of the zero eigenvalues of a correlation matrix.
constexpr double kEigenvalueRounding = 1e-9;

[[noreturn]] void refuse_answer(const std::string& reason) { throw ProgramError(reason); }

/// Returns whether the line has NaN or Infinity, which Python and others write although JSON has
/// neither.
bool names_no_number(std::string_view line) {
  return line.find("NaN") != line.npos || line.find("Infinity") != line.npos;
}

/// Returns whether brackets are nested deeper than in any valid answer. A parser needs memory for
/// each level.
bool is_too_deep(std::string_view line) {
  int depth = 0;
  for (const char c : line) {
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepest) return true;
  }
  return false;
}

Answer parsed_answer(std::string_view line) {
  if (is_too_deep(line)) refuse_answer("answer has too many brackets within brackets");
  Answer answer = Answer::parse(line, nullptr, false);
  if (!answer.is_discarded()) return answer;
  if (names_no_number(line)) refuse_answer("answer holds NaN or Infinity");
  refuse_answer("answer is not JSON: " + excerpt(line));
}

/// The JSON object in a line. It must answer message `id` and have no other members than these.
Answer object_in(std::string_view line, std::uint64_t id,
                 std::initializer_list<std::string_view> members) {
  Answer answer = parsed_answer(line);
  if (!answer.is_object()) refuse_answer("answer is no JSON object: " + excerpt(line));
  const auto number = answer.find("id");
  if (number == answer.end() || !number->is_number_unsigned() || *number != id)
    refuse_answer(formatted("answer has not the message's id {}: {}", id, excerpt(line)));
  for (const auto& [name, value] : answer.items()) {
    if (name != "id" && std::ranges::find(members, name) == members.end())
      refuse_answer(formatted("answer has an unknown member '{}'", excerpt(name)));
  }
  return answer;
}

double finite_number(const Answer& value, const std::string& what) {
  if (value.is_null()) refuse_answer(what + " is not a number");
  if (!value.is_number())
    refuse_answer(formatted("{} is not a number: {}", what, excerpt(value.dump())));
  const double number = value.get<double>();
  if (!std::isfinite(number)) refuse_answer(what + " is not finite");
  return number;
}

const Answer& member(const Answer& answer, const char* name) {
  const auto found = answer.find(name);
  if (found == answer.end()) refuse_answer(std::string("answer has no ") + name);
  return *found;
}

void expect_array(const Answer& value, std::size_t size, const std::string& what) {
  if (value.is_array() && value.size() == size) return;
  refuse_answer(formatted("{} is no array of {}", what, size));
}

/// Throws ProgramError unless C is a covariance: no variance is negative, and no eigenvalue of the
/// correlations is negative beyond rounding. C may be singular, e.g. for a pose that is known
/// exactly.
void expect_covariance(const Eigen::MatrixXd& C, const std::string& what) {
  const Eigen::Index n = C.rows();
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (C(i, i) < 0.0) refuse_answer(what + " is not positive definite: a variance is negative");
    scale(i) = C(i, i) > 0.0 ? 1.0 / std::sqrt(C(i, i)) : 0.0;
    if (C(i, i) == 0.0 && !C.row(i).isZero(0.0))
      refuse_answer(what + " is not positive definite: correlation with a variance of zero");
  }
  const Eigen::MatrixXd correlations = scale.asDiagonal() * C * scale.asDiagonal();
  if (!correlations.allFinite())
    refuse_answer(what + " is not positive definite: beyond all bounds");
  // If the raised matrix is positive definite, no eigenvalue is below the negative tolerance.
  const Eigen::MatrixXd raised =
      correlations + kEigenvalueRounding * Eigen::MatrixXd::Identity(n, n);
  if (raised.llt().info() != Eigen::Success) refuse_answer(what + " is not positive definite");
}

Eigen::Matrix3d covariance_in(const Answer& value) {
  expect_array(value, 3, "covariance");
  Eigen::Matrix3d C;
  for (int i = 0; i < 3; ++i) {
    const Answer& row = value[static_cast<std::size_t>(i)];
    expect_array(row, 3, "a row of the covariance");
    for (int j = 0; j < 3; ++j)
      C(i, j) = finite_number(row[static_cast<std::size_t>(j)], "covariance");
  }
  const Eigen::Vector3d sigma = C.diagonal().cwiseAbs().cwiseSqrt();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) {
      if (std::abs(C(i, j) - C(j, i)) > kEigenvalueRounding * sigma(i) * sigma(j))
        refuse_answer("covariance is not symmetric");
    }
  }
  C = (0.5 * (C + C.transpose())).eval();
  expect_covariance(C, "covariance");
  return C;
}

double optional_number(const Answer& answer, const char* name) {
  const auto found = answer.find(name);
  return found == answer.end() ? 0.0 : finite_number(*found, name);
}

std::uint32_t optional_count(const Answer& answer, const char* name) {
  const auto found = answer.find(name);
  if (found == answer.end()) return 0;
  const bool fits = found->is_number_unsigned() &&
                    found->get<std::uint64_t>() <= std::numeric_limits<std::uint32_t>::max();
  if (!fits)
    refuse_answer(formatted("{} is no whole number from 0: {}", name, excerpt(found->dump())));
  return found->get<std::uint32_t>();
}

/// One row of a map: number, x, y, xx, xy, yy.
std::pair<std::size_t, LandmarkEstimate> landmark_in(const Answer& row) {
  expect_array(row, 6, "a landmark of the map");
  if (!row[0].is_number_unsigned())
    refuse_answer("a landmark's number is no whole number from 0: " + excerpt(row[0].dump()));
  std::array<double, 5> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = finite_number(row[i + 1], "map");
  const auto [x, y, xx, xy, yy] = numbers;
  LandmarkEstimate landmark{{x, y}, Eigen::Matrix2d{{xx, xy}, {xy, yy}}};
  expect_covariance(landmark.covariance, "a landmark's covariance");
  return {row[0].get<std::size_t>(), landmark};
}

}  // namespace

void read_started(std::string_view line, std::uint64_t id) { object_in(line, id, {}); }

ProgramEstimate read_estimate(std::string_view line, std::uint64_t id) {
  const Answer answer = object_in(
      line, id, {"mean", "covariance", "log_likelihood", "nis", "nis_dof", "ess", "map_size"});
  const Answer& mean = member(answer, "mean");
  expect_array(mean, 3, "mean");
  ProgramEstimate estimate;
  estimate.pose.mean = {.x = finite_number(mean[0], "mean"),
                        .y = finite_number(mean[1], "mean"),
                        .heading = wrap(finite_number(mean[2], "mean"))};
  estimate.pose.covariance = covariance_in(member(answer, "covariance"));
  const double nis = optional_number(answer, "nis");
  if (nis < 0.0)
    refuse_answer("nis is negative: is the innovation's covariance positive definite?");
  estimate.report = {.ess = optional_number(answer, "ess"),
                     .log_likelihood = optional_number(answer, "log_likelihood"),
                     .nis = nis,
                     .nis_dof = optional_count(answer, "nis_dof"),
                     .map_size = optional_number(answer, "map_size")};
  return estimate;
}

void read_map(std::string_view line, std::uint64_t id, Association association,
              std::span<std::optional<LandmarkEstimate>> landmarks) {
  const Answer answer = object_in(line, id, {"map"});
  const Answer& map = member(answer, "map");
  if (!map.is_array()) refuse_answer("map is no array");
  for (const Answer& row : map) {
    const auto [number, landmark] = landmark_in(row);
    if (number >= landmarks.size()) {
      if (association == Association::nearest) continue;
      refuse_answer(
          formatted("the map has landmark {}, the world has {}", number, landmarks.size()));
    }
    if (landmarks[number]) refuse_answer(formatted("the map has landmark {} twice", number));
    landmarks[number] = landmark;
  }
}

}  // namespace montecarta::experiments
