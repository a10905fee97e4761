// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::models {

/// One thing that a user may set: of a filter behind its name in a cell line (an option of that
/// filter), of a study in a section of its file (a setting). Keys that end in _deg are in degrees,
/// all others in SI units.
struct Parameter {
  enum class Kind : std::uint8_t {
    text,     ///< anything
    number,   ///< finite, from `least` to `most`
    count,    ///< whole, from `least` to `most`
    choice,   ///< one of `choices`
    choices,  ///< a list out of `choices`
  };
  std::string key = {};
  Kind kind = Kind::text;
  std::string unit = {};                     ///< "" where there is none
  std::optional<std::string> fallback = {};  ///< default value, as text; nullopt: must be given
  double least = 0.0;                        ///< inclusive, as `most`
  double most = 0.0;
  std::vector<std::string> choices = {};
  std::string meaning = {};  ///< one line, with unit and equation
  std::string example = {};  ///< offered as remedy where there is no fallback
  /// The default of a filter's option where its controls are noisy measurements of the true ones
  /// (scenario.noise = measured-control), if that differs.
  std::optional<std::string> fallback_if_measured = {};
  /// Vehicles or sensors that have it; empty: all.
  std::vector<std::string> applies_to = {};
};

Parameter number_parameter(const char* key, const char* fallback, double least, double most,
                           const char* meaning, const char* unit = "");
Parameter count_parameter(const char* key, const std::string& fallback, double least, double most,
                          const char* meaning);
Parameter choice_parameter(const char* key, const std::string& fallback,
                           std::vector<std::string> choices, const char* meaning);

/// What a component of a detection or of a control is.
enum class Quantity : std::uint8_t {
  range,
  bearing,
  forward,  ///< of a landmark
  left,
  speed,
  steer,
  yaw_rate,
  forward_speed,
  left_speed
};

/// Whether a detection of it is an angle, which wraps.
constexpr bool wraps(Quantity quantity) { return quantity == Quantity::bearing; }

/// A component as messages, logs and study files name it.
struct Component {
  const char* name;    ///< "range": in messages and errors
  const char* column;  ///< "range_m": in detections.csv or odometry.csv
  double most;         ///< greatest size that a log may hold
  const char* limit;   ///< "metres, a finite number": why a log with more is refused
  Parameter sigma;     ///< the standard deviation of its noise
};
const Component& component_of(Quantity quantity);

}  // namespace montecarta::models
