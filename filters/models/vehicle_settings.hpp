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

/// Vehicles as study files, result files and messages name them: all of it follows from the list of
/// vehicles (vehicle.hpp).
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
/// A setting as it is computed with.
inline double in_si(std::string_view key, double value) {
  return is_in_degrees(key) ? value / 180.0 * kPi : value;
}
/// A key without its _deg: the name of a number in SI units.
inline std::string si_name(std::string_view key) {
  if (is_in_degrees(key)) key.remove_suffix(std::string_view("_deg").size());
  return std::string(key);
}

/// One thing that a study file may say of some of the vehicles.
struct VehicleSetting {
  std::string key = {};
  std::string unit = {};
  std::string usual = {};
  double least = 0.0, most = 0.0;
  std::string meaning = {};
  std::string example = {};                ///< not empty: a log of the user's own must give it
  std::vector<std::string> choices = {};   ///< not empty: one of these, and no number
  std::vector<std::string> vehicles = {};  ///< names of those that have it
};

/// Gathers settings, each key once.
class VehicleSettings {
 public:
  template <class V>
  void add(VehicleSetting setting, const V& vehicle) {
    auto found = std::ranges::find(settings_, setting.key, &VehicleSetting::key);
    if (found == settings_.end()) found = settings_.insert(found, std::move(setting));
    for (const char* name : vehicle.kNames) found->vehicles.emplace_back(name);
  }
  std::vector<VehicleSetting> take() { return std::move(settings_); }

 private:
  std::vector<VehicleSetting> settings_;
};

/// Calls `use(key, member)` for the choice of integration of a vehicle that has it.
template <class V, class Use>
void for_each_choice(V& vehicle, const Use& use) {
  if constexpr (requires { vehicle.integration; }) use("integration", vehicle.integration);
}

/// What vehicles are described by, as far as it is asked for where `use` says.
inline std::vector<VehicleSetting> vehicle_settings(VehicleUse use) {
  VehicleSettings settings;
  for_each_vehicle([&](auto one) {
    for (const auto& n : one.numbers()) {
      if (n.use != use) continue;
      settings.add({n.key, n.unit, n.usual, n.least, n.most, n.meaning, n.example}, one);
    }
    if (use != VehicleUse::motion) return;
    for_each_choice(one, [&](const char* key, Integration) {
      settings.add({.key = key,
                    .usual = kIntegrationNames[0],
                    .meaning = "a step: its exact arc, or along the heading before it",
                    .choices = {kIntegrationNames.begin(), kIntegrationNames.end()}},
                   one);
    });
  });
  return settings.take();
}

/// Deviations of the controls of all vehicles.
inline std::vector<VehicleSetting> control_noise_settings() {
  VehicleSettings settings;
  for_each_vehicle([&](const auto& one) {
    for (const ControlName& c : one.kControls) {
      settings.add({c.sigma, c.unit, c.usual, 0.0, c.most_sigma, c.noise_text, c.usual}, one);
    }
  });
  return settings.take();
}

/// Key of alpha i, from 0.
inline std::string alpha_key(std::size_t i) { return "alpha_" + std::to_string(i + 1); }

/// The value of a key as it is written; nullopt where it is not.
using SettingText = std::function<std::optional<std::string>(const std::string& key)>;
/// The same as a number.
using SettingNumber = std::function<std::optional<double>(const std::string& key)>;

/// The vehicle of that name, with what is said of it and the rest as usual; nullopt where there is
/// none of that name.
inline std::optional<Vehicle> vehicle_named(std::string_view name, const SettingText& text,
                                            const SettingNumber& number) {
  std::optional<Vehicle> found;
  for_each_vehicle([&](const auto& kind) {
    if (std::ranges::find(kind.kNames, name, [](const char* n) { return std::string_view(n); }) ==
        std::end(kind.kNames))
      return;
    auto vehicle = kind.named(name);
    for (const auto& n : vehicle.numbers()) {
      if (const auto value = number(n.key)) vehicle.*(n.member) = in_si(n.key, *value);
    }
    for_each_choice(vehicle, [&](const char* key, Integration& integration) {
      if (text(key) == kIntegrationNames[1]) integration = Integration::euler;
    });
    found = vehicle;
  });
  return found;
}

/// The choices and numbers of a vehicle, as messages tell them: `tell(name, number)` in SI units,
/// `tell(name, word)`.
template <class Tell>
void tell_vehicle(const Vehicle& vehicle, const Tell& tell) {
  std::visit(
      [&](auto one) {
        for (const auto& n : one.numbers()) {
          if (n.use == VehicleUse::motion) tell(si_name(n.key), one.*(n.member));
        }
        for_each_choice(one, [&](const char* key, Integration integration) {
          tell(std::string(key), kIntegrationNames[integration == Integration::arc ? 0 : 1]);
        });
      },
      vehicle);
}

/// The noise of the controls of that vehicle; nullopt where a deviation is missing.
inline std::optional<ControlNoise> control_noise_of(const Vehicle& vehicle,
                                                    const SettingNumber& number) {
  ControlNoise noise;
  std::size_t i = 0;
  for (const ControlName& control : controls_of(vehicle)) {
    const std::optional<double> value = number(control.sigma);
    if (!value) return std::nullopt;
    noise.sigma[i++] = in_si(control.sigma, *value);
  }
  for (std::size_t k = 0; k < noise.alpha.size(); ++k) {
    noise.alpha[k] = number(alpha_key(k)).value_or(0.0);
  }
  return noise;
}

}  // namespace montecarta::models
