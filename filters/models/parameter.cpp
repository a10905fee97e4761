// SPDX-License-Identifier: BSD-3-Clause
#include "filters/models/parameter.hpp"

#include "engine/numbers/angle.hpp"

#include <array>
#include <cstddef>
#include <utility>

namespace montecarta::models {
namespace {

/// A component and the standard deviation of its noise, from `key` on.
Component component(const char* name, const char* column, double most, const char* limit,
                    const char* key, const char* unit, const char* fallback, double most_sigma,
                    const char* meaning, const char* example) {
  Parameter sigma = number_parameter(key, fallback, 0.0, most_sigma, meaning, unit);
  sigma.example = example;
  return {name, column, most, limit, std::move(sigma)};
}

/// The order is that of the enumerators.
std::array<Component, 9> all_components() {
  constexpr const char* kMetres = "metres, a finite number";
  constexpr const char* kSpeed = "metres per second, at most 1000";
  return {
      component("range", "range_m", 1e6, kMetres, "sigma_range", "m", "0.1", 1000,
                "standard deviation of a range", "0.5"),
      component("bearing", "bearing_rad", 2 * kPi, "radians relative to the heading",
                "sigma_bearing_deg", "deg", "1", 180, "standard deviation of a bearing", "1.5"),
      component("forward", "forward_m", 1e6, kMetres, "sigma_position_forward", "m", "0.1", 1000,
                "standard deviation along the sensor's heading", "0.1"),
      component("left", "left_m", 1e6, kMetres, "sigma_position_left", "m", "0.1", 1000,
                "standard deviation across the sensor's heading", "0.1"),
      component("speed", "speed_mps", 1e3, kSpeed, "sigma_speed", "m/s", "0.3", 1000,
                "standard deviation of the speed", "0.3"),
      component("steer", "steer_rad", kPi / 2, "radians, at most pi / 2", "sigma_steer_deg", "deg",
                "3", 180, "standard deviation of the steering angle", "3"),
      component("yaw_rate", "yaw_rate_radps", 100, "radians per second, at most 100",
                "sigma_yaw_rate_deg", "deg/s", "3", 1e4, "standard deviation of the yaw rate", "3"),
      component("forward", "forward_mps", 1e3, kSpeed, "sigma_forward", "m/s", "0.3", 1000,
                "standard deviation of the forward speed", "0.3"),
      component("left", "left_mps", 1e3, kSpeed, "sigma_left", "m/s", "0.3", 1000,
                "standard deviation of the speed to the left", "0.3")};
}

}  // namespace

Parameter number_parameter(const char* key, const char* fallback, double least, double most,
                           const char* meaning, const char* unit) {
  return {.key = key,
          .kind = Parameter::Kind::number,
          .unit = unit,
          .fallback = fallback,
          .least = least,
          .most = most,
          .meaning = meaning};
}

Parameter count_parameter(const char* key, const std::string& fallback, double least, double most,
                          const char* meaning) {
  return {.key = key,
          .kind = Parameter::Kind::count,
          .fallback = fallback,
          .least = least,
          .most = most,
          .meaning = meaning};
}

Parameter choice_parameter(const char* key, const std::string& fallback,
                           std::vector<std::string> choices, const char* meaning) {
  return {.key = key,
          .kind = Parameter::Kind::choice,
          .fallback = fallback,
          .choices = std::move(choices),
          .meaning = meaning};
}

const Component& component_of(Quantity quantity) {
  static const std::array<Component, 9> all = all_components();
  return all[static_cast<std::size_t>(quantity)];
}

}  // namespace montecarta::models
