// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/numbers/angle.hpp"

#include <array>
#include <cstddef>

namespace montecarta::models {

/// What a component of a detection is.
enum class Quantity { range, bearing, forward, left };

/// One component of a detection, as messages, logs and study files name it. Keys that end in _deg
/// are in degrees, everything else in SI units.
struct DetectionName {
  const char* name;        ///< "range": in messages and errors
  const char* column;      ///< "range_m": in detections.csv
  bool wraps;              ///< whether it is an angle
  bool is_positive;        ///< whether it must be above 0
  double most;             ///< greatest size that a log may hold
  const char* limit;       ///< "metres, a finite number": why a log with more is refused
  const char* sigma;       ///< "sigma_range": key of its noise
  const char* unit;        ///< of that key
  const char* usual;       ///< value of that key where nothing is said
  double most_sigma;       ///< greatest value of that key
  const char* noise_text;  ///< what that key means
  const char* example;     ///< value of that key that an error suggests
};

/// In the order of the enumerators.
inline constexpr std::array<DetectionName, 4> kDetectionNames = {
    {{"range", "range_m", false, true, 1e6, "metres, a finite number", "sigma_range", "m", "0.1",
      1000, "noise of a range", "0.5"},
     {"bearing", "bearing_rad", true, false, 2 * kPi, "radians relative to the heading",
      "sigma_bearing_deg", "deg", "1", 180, "noise of a bearing", "1.5"},
     {"forward", "forward_m", false, false, 1e6, "metres, a finite number",
      "sigma_position_forward", "m", "0.1", 1000, "noise of a position along the sensor's heading",
      "0.1"},
     {"left", "left_m", false, false, 1e6, "metres, a finite number", "sigma_position_left", "m",
      "0.1", 1000, "noise of a position across the sensor's heading", "0.1"}}};

constexpr const DetectionName& name_of(Quantity quantity) {
  return kDetectionNames[static_cast<std::size_t>(quantity)];
}

/// The standard deviation that `owner` (a belief, a scenario) has of a quantity.
template <class Owner>
auto& deviation_of(Quantity quantity, Owner& owner) {
  switch (quantity) {
    case Quantity::range:
      return owner.sigma_range;
    case Quantity::bearing:
      return owner.sigma_bearing;
    case Quantity::forward:
      return owner.sigma_forward;
    case Quantity::left:
      break;
  }
  return owner.sigma_left;
}

}  // namespace montecarta::models
