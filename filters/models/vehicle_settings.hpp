// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/vehicle.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Names and settings of vehicles in study files, result files and messages. All of them follow
/// from the list of vehicles in vehicle.hpp.
namespace montecarta::models {

/// Calls `visit` with one vehicle of each type, in the order of the list.
template <class Visit>
void for_each_vehicle(const Visit& visit) {
  const auto each = [&]<std::size_t... I>(std::index_sequence<I...>) {
    (visit(std::variant_alternative_t<I, Vehicle>{}), ...);
  };
  each(std::make_index_sequence<std::variant_size_v<Vehicle>>());
}

inline std::string name_of(const Vehicle& vehicle) {
  return std::visit([](const auto& one) { return std::string(one.name()); }, vehicle);
}

/// Names of all vehicles, the default first.
inline std::vector<std::string> vehicle_names() {
  std::vector<std::string> names;
  for_each_vehicle([&](const auto& one) {
    names.insert(names.end(), std::begin(one.kNames), std::end(one.kNames));
  });
  return names;
}

inline bool is_in_degrees(std::string_view key) { return key.ends_with("_deg"); }
/// Converts the value of a setting to SI units.
inline double in_si(std::string_view key, double value) {
  return is_in_degrees(key) ? value / 180.0 * kPi : value;
}
/// A key without its _deg, the name of the same number in SI units.
inline std::string si_name(std::string_view key) {
  if (is_in_degrees(key)) key.remove_suffix(std::string_view("_deg").size());
  return std::string(key);
}

/// Adds a parameter of a vehicle; if its key was added before, adds only the vehicle's names to it.
template <class V>
void add_parameter(Parameter parameter, const V& vehicle, std::vector<Parameter>& all) {
  auto found = std::ranges::find(all, parameter.key, &Parameter::key);
  if (found == all.end()) found = all.insert(found, std::move(parameter));
  for (const char* name : vehicle.kNames) found->applies_to.emplace_back(name);
}

/// Calls `use(key, member)` for the choice of integration if the vehicle has one.
template <class V, class Use>
void for_each_choice(V& vehicle, const Use& use) {
  if constexpr (requires { vehicle.integration; }) use("integration", vehicle.integration);
}

/// The parameters of all vehicles that are set for the given use.
inline std::vector<Parameter> vehicle_parameters(VehicleUse use) {
  std::vector<Parameter> all;
  for_each_vehicle([&](auto one) {
    for (const auto& number : one.numbers()) {
      if (number.use == use) add_parameter(number.parameter, one, all);
    }
    if (use != VehicleUse::motion) return;
    for_each_choice(one, [&](const char* key, Integration) {
      add_parameter(choice_parameter(key, kIntegrationNames[0],
                                     {kIntegrationNames.begin(), kIntegrationNames.end()},
                                     "a step: its exact arc, or along the heading before it"),
                    one, all);
    });
  });
  return all;
}

/// Standard deviations of the controls of all vehicles.
inline std::vector<Parameter> control_noise_parameters() {
  std::vector<Parameter> all;
  for_each_vehicle([&](const auto& one) {
    for (const Quantity control : one.kControls) {
      add_parameter(component_of(control).sigma, one, all);
    }
  });
  return all;
}

/// Key of alpha[i]; keys count from 1.
inline std::string alpha_key(std::size_t i) { return "alpha_" + std::to_string(i + 1); }

/// Names of IncrementModel in study files, in the order of the enumerators.
inline constexpr std::array<const char*, 3> kIncrementNames = {"none", "additive", "odometry"};
/// Keys of IncrementNoise::sigma.
inline constexpr std::array<const char*, 3> kIncrementKeys = {
    "sigma_increment_forward", "sigma_increment_left", "sigma_increment_heading_deg"};
/// Key of IncrementNoise::alpha[i].
inline std::string odometry_key(std::size_t i) { return "odometry_" + alpha_key(i); }

/// The text of a setting; nullopt if it is not set.
using SettingText = std::function<std::optional<std::string>(const std::string& key)>;
/// The value of a setting as a number; nullopt if it is not set.
using SettingNumber = std::function<std::optional<double>(const std::string& key)>;

/// The vehicle of that name with the given settings and defaults for all others; nullopt if there
/// is no vehicle of that name.
inline std::optional<Vehicle> vehicle_named(std::string_view name, const SettingText& text,
                                            const SettingNumber& number) {
  std::optional<Vehicle> found;
  for_each_vehicle([&](const auto& kind) {
    if (std::ranges::find(kind.kNames, name, [](const char* n) { return std::string_view(n); }) ==
        std::end(kind.kNames))
      return;
    auto vehicle = kind.named(name);
    for (const auto& n : vehicle.numbers()) {
      const std::string& key = n.parameter.key;
      if (const auto value = number(key)) vehicle.*(n.member) = in_si(key, *value);
    }
    for_each_choice(vehicle, [&](const char* key, Integration& integration) {
      if (text(key) == kIntegrationNames[1]) integration = Integration::euler;
    });
    found = vehicle;
  });
  return found;
}

/// Calls `use(name, number)`, in SI units, or `use(name, word)` for every number and choice of a
/// vehicle, for messages.
template <class Use>
void for_each_setting(const Vehicle& vehicle, const Use& use) {
  std::visit(
      [&](auto one) {
        for (const auto& n : one.numbers()) {
          if (n.use == VehicleUse::motion) use(si_name(n.parameter.key), one.*(n.member));
        }
        for_each_choice(one, [&](const char* key, Integration integration) {
          use(std::string(key), kIntegrationNames[integration == Integration::arc ? 0 : 1]);
        });
      },
      vehicle);
}

/// The noise of a step. Its model is that of the settings that are there.
inline IncrementNoise increment_noise_of(const SettingNumber& number) {
  IncrementNoise noise;
  for (std::size_t i = 0; i < noise.sigma.size(); ++i) {
    const auto value = number(kIncrementKeys[i]);
    if (!value) continue;
    noise.model = IncrementModel::additive;
    noise.sigma[i] = in_si(kIncrementKeys[i], *value);
  }
  for (std::size_t i = 0; i < noise.alpha.size(); ++i) {
    const auto value = number(odometry_key(i));
    if (!value) continue;
    noise.model = IncrementModel::odometry;
    noise.alpha[i] = *value;
  }
  return noise;
}

/// The noise of the controls of a vehicle; nullopt if a deviation is not set.
inline std::optional<ControlNoise> control_noise_of(const Vehicle& vehicle,
                                                    const SettingNumber& number) {
  ControlNoise noise;
  std::size_t i = 0;
  for (const Quantity control : controls_of(vehicle)) {
    const std::string& key = component_of(control).sigma.key;
    const std::optional<double> value = number(key);
    if (!value) return std::nullopt;
    noise.sigma[i++] = in_si(key, *value);
  }
  for (std::size_t k = 0; k < noise.alpha.size(); ++k) {
    noise.alpha[k] = number(alpha_key(k)).value_or(0.0);
  }
  noise.increment = increment_noise_of(number);
  return noise;
}

}  // namespace montecarta::models
