// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::models {

/// A value that a user may set: an option of a filter, after its name in a cell line, or a setting
/// in a section of a study file. Keys that end in _deg are in degrees, all others in SI units.
struct Parameter {
  enum class Kind : std::uint8_t {
    text,     ///< any text
    number,   ///< finite, from `least` to `most`
    count,    ///< a whole number, from `least` to `most`
    choice,   ///< one of `choices`
    choices,  ///< a list of some of `choices`
  };
  std::string key = {};
  Kind kind = Kind::text;
  std::string unit = {};                     ///< unit; "" if it has none
  std::optional<std::string> fallback = {};  ///< default value as text; nullopt: must be set
  double least = 0.0;                        ///< least value, inclusive like `most`
  double most = 0.0;
  std::vector<std::string> choices = {};
  std::string meaning = {};  ///< explanation in one line, with equation
  std::string example = {};  ///< suggested by the error if the user must set it
  /// The default of a filter's option if the controls are noisy measurements of the true ones
  /// (scenario.noise = measured-control), where it differs.
  std::optional<std::string> fallback_if_measured = {};
  /// Names of the vehicles or sensors that have the parameter; empty means all.
  std::vector<std::string> applies_to = {};
};

Parameter number_parameter(const char* key, const char* fallback, double least, double most,
                           const char* meaning, const char* unit = "");
Parameter count_parameter(const char* key, const std::string& fallback, double least, double most,
                          const char* meaning);
Parameter choice_parameter(const char* key, const std::string& fallback,
                           std::vector<std::string> choices, const char* meaning);

/// The quantity that one component of a detection or of a control measures.
enum class Quantity : std::uint8_t {
  range,
  bearing,
  forward,  ///< forward and left: position of a landmark relative to the sensor
  left,
  speed,
  steer,
  yaw_rate,
  forward_speed,
  left_speed
};

/// Returns whether the quantity, as part of a detection, is an angle that wraps.
constexpr bool wraps(Quantity quantity) { return quantity == Quantity::bearing; }

/// Names and limits of a component in messages, logs and study files.
struct Component {
  const char* name;    ///< name in messages, for instance "range"
  const char* column;  ///< name in files, e.g. "range_m" in detections.csv or odometry.csv
  double most;         ///< greatest magnitude allowed in a log
  const char* limit;   ///< the limit in words, for instance "metres, a finite number"
  Parameter sigma;     ///< standard deviation of its noise
};
const Component& component_of(Quantity quantity);

}  // namespace montecarta::models
