// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/simulated_world.hpp"

#include "filters/models/vehicle_settings.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace montecarta::analysis {
namespace {

/// Settings of a scenario by name, with a flag for missing settings.
class Facts {
 public:
  explicit Facts(const TextPairs& pairs) : pairs_(&pairs) {}

  std::optional<std::string> optional_text(const std::string& name) const {
    const auto found =
        std::ranges::find_if(*pairs_, [&](const auto& p) { return p.first == name; });
    return found == pairs_->end() ? std::nullopt : std::optional(found->second);
  }
  std::optional<double> optional_number(const std::string& name) const {
    const std::optional<std::string> written = optional_text(name);
    if (!written) return std::nullopt;
    double value = 0.0;
    const auto end = written->data() + written->size();
    if (std::from_chars(written->data(), end, value).ptr != end) return std::nullopt;
    return value;
  }
  std::string text(const std::string& name) { return needed(optional_text(name)); }
  double number(const std::string& name) { return needed(optional_number(name)); }
  double si(const std::string& name) { return in_si(name, number(name)); }
  bool complete() const { return complete_; }

 private:
  template <class Value>
  Value needed(const std::optional<Value>& value) {
    complete_ = complete_ && value.has_value();
    return value.value_or(Value());
  }

  const TextPairs* pairs_;
  bool complete_ = true;
};

/// The sensor with its mount, which files omit if it is the usual one; nullopt if the sensor is
/// unknown.
std::optional<Sensor> sensor_of(const Facts& facts) {
  const auto usual = [&](const char* key) {
    return in_si(key, facts.optional_number(key).value_or(0.0));
  };
  return sensor_named(facts.optional_text("sensor").value_or(name_of(Sensor())),
                      {.forward = usual("mount_forward"),
                       .left = usual("mount_left"),
                       .turn = wrap(usual("mount_turn_deg"))});
}

Eigen::Vector2d sigma_of(Facts& facts, const Sensor& sensor) {
  Eigen::Vector2d sigma = Eigen::Vector2d::Ones();
  Eigen::Index i = 0;
  for (const Quantity quantity : components_of(sensor)) {
    sigma(i++) = facts.si(component_of(quantity).sigma.key);
  }
  return sigma;
}

/// The deviations whose names begin with `section`. Files omit deviations of 0.
PriorDeviations prior_of(const Facts& facts, const std::string& section) {
  const auto usual = [&](const char* key) {
    return in_si(key, facts.optional_number(section + key).value_or(0.0));
  };
  return {.position = usual("start_sigma_m"),
          .heading = usual("start_sigma_deg"),
          .landmark = usual("map_sigma_m")};
}

}  // namespace

bool map_is_known(const ResultFile& file) {
  return Facts(file.scenario()).optional_text("belief.map") == "known";
}

PriorDeviations believed_prior_of(const ResultFile& file) {
  return map_is_known(file) ? prior_of(Facts(file.scenario()), "belief.") : PriorDeviations();
}

std::optional<SimulatedWorld> simulated_world_of(const ResultFile& file) {
  Facts facts(file.scenario());
  if (facts.text("kind") != "simulated" || !file.has_truth()) return std::nullopt;
  const std::optional<Vehicle> vehicle = vehicle_named(
      facts.text("vehicle"), [&](const auto& key) { return std::optional(facts.text(key)); },
      [&](const auto& key) { return std::optional(facts.number(key)); });
  if (!vehicle) return std::nullopt;
  const std::optional<ControlNoise> control_noise =
      control_noise_of(*vehicle, [&](const auto& key) { return facts.optional_number(key); });
  if (!control_noise) return std::nullopt;
  const std::optional<Sensor> sensor = sensor_of(facts);
  if (!sensor) return std::nullopt;
  SimulatedWorld world{
      .vehicle = *vehicle,
      .control_noise = *control_noise,
      .sigma_observation = sigma_of(facts, *sensor),
      .detected = 1.0 - facts.number("miss_probability"),
      .view = FieldOfView(facts.number("max_range"), facts.si("field_of_view_deg"),
                          sensor->mounting, facts.optional_number("min_range").value_or(0.0)),
      .same_path = facts.text("noise") != "matched",
      .sensor = *sensor};
  if (map_is_known(file)) world.prior = prior_of(facts, "");
  if (facts.optional_text("fixes") == "position") {
    const double scans = std::round(facts.number("scan_rate") / facts.number("fix_rate"));
    if (!(scans >= 1.0) || scans > 1e9) return std::nullopt;
    world.scans_per_fix = static_cast<std::size_t>(scans);
    world.sigma_fix = facts.si("sigma_fix");
  }
  if (!facts.complete()) return std::nullopt;
  return world;
}

}  // namespace montecarta::analysis
