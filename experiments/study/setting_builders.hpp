// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/setting.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <string>
#include <utility>
#include <vector>

/// How the rows of the table of settings are written.
namespace montecarta::experiments::setting_builders {

inline constexpr double kTiny = 1e-6;  // least of what must be positive
inline constexpr double kMostSeed = 18446744073709551615.0;

inline Setting text(const char* section, const char* key, const char* meaning) {
  return {{.key = key, .fallback = "", .meaning = meaning}, section};
}

inline Setting number(const char* section, const char* key, const char* unit, const char* fallback,
                      double least, double most, const char* meaning) {
  Setting setting{number_option(key, fallback, least, most, meaning), section};
  setting.unit = unit;
  return setting;
}

inline Setting count(const char* section, const char* key, const char* fallback, double least,
                     double most, const char* meaning) {
  return {count_option(key, fallback, least, most, meaning), section};
}

/// The first choice is the default.
inline Setting choice(const char* section, const char* key, std::vector<std::string> choices,
                      const char* meaning) {
  const std::string first = choices.front();
  return {choice_option(key, first, std::move(choices), meaning), section};
}

/// Without a default; `example` is offered as remedy.
inline Setting required(Setting setting, const char* example) {
  setting.fallback.reset();
  setting.example = example;
  return setting;
}

/// Of these kinds of scenario only.
inline Setting only_for(std::vector<std::string> kinds, Setting setting) {
  setting.kinds = std::move(kinds);
  return setting;
}

/// A setting of some vehicles.
inline Setting of_vehicles(const char* section, const VehicleSetting& v) {
  const bool is_choice = !v.choices.empty();
  Setting setting{
      is_choice ? choice_option(v.key.c_str(), v.usual, v.choices, v.meaning.c_str())
                : number_option(v.key.c_str(), v.usual.c_str(), v.least, v.most, v.meaning.c_str()),
      section};
  setting.unit = v.unit;
  setting.chooser = "vehicle";
  setting.chosen = v.vehicles;
  return setting;
}

/// The deviation of a component of some sensors, from `least` on.
inline Setting deviation_setting(const char* section, Quantity quantity, double least) {
  const DetectionName& c = name_of(quantity);
  Setting setting = number(section, c.sigma, c.unit, c.usual, least, c.most_sigma, c.noise_text);
  setting.chooser = "sensor";
  setting.chosen = sensors_with(quantity);
  return setting;
}

/// Left out of the resolved text where it says nothing.
inline Setting quiet(Setting setting) {
  setting.is_quiet = true;
  return setting;
}

/// With another default where the scenario is of that kind.
inline Setting but_for(const char* kind, const char* fallback, Setting setting) {
  setting.fallback_of_kind.emplace_back(kind, fallback);
  return setting;
}

void add_scenario(std::vector<Setting>& table);
void add_belief(std::vector<Setting>& table);

}  // namespace montecarta::experiments::setting_builders
