// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/messages.hpp"

#include "analysis/page/json.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <array>
#include <type_traits>

namespace montecarta::experiments {
namespace {

JsonWriter json_message(std::uint64_t id, const char* type) {
  JsonWriter json;
  json.begin_object().member("id", id).member("type", type);
  return json;
}

void exact_row(JsonWriter& json, std::span<const double> numbers) {
  json.begin_array();
  for (const double number : numbers) json.exact(number);
  json.end_array();
}

void tell_controls(JsonWriter& json, std::span<const ControlRow> controls) {
  json.key("controls").begin_array();
  for (const ControlRow& control : controls) exact_row(json, control);
  json.end_array();
}

void tell_control_names(JsonWriter& json, const Vehicle& vehicle) {
  json.key("controls").begin_array();
  for (const ControlName& control : controls_of(vehicle)) json.value(control.name);
  json.end_array();
}

void tell_control_noise(JsonWriter& json, const Vehicle& vehicle, const ControlNoise& noise) {
  std::size_t i = 0;
  for (const ControlName& control : controls_of(vehicle)) {
    json.key(si_name(control.sigma)).exact(noise.sigma[i++]);
  }
  if (!noise.grows()) return;
  for (std::size_t k = 0; k < noise.alpha.size(); ++k) json.key(alpha_key(k)).exact(noise.alpha[k]);
}

void tell_sensor(JsonWriter& json, const Belief& belief) {
  const auto& [forward, left, turn] = belief.sensor.mounting;
  json.member("sensor", name_of(belief.sensor));
  for (const Quantity quantity : components_of(belief.sensor)) {
    json.key(si_name(name_of(quantity).sigma)).exact(deviation_of(quantity, belief));
  }
  if (belief.sensor.mounting.is_none()) return;
  json.key("mount_forward").exact(forward);
  json.key("mount_left").exact(left);
  json.key("mount_turn").exact(turn);
}

void tell_settings(JsonWriter& json, const FilterSetup& setup) {
  const Belief& belief = setup.belief;
  const Vehicle& vehicle = belief.vehicle;
  const bool known = setup.association.kind == Association::known;
  json.key("settings").begin_object();
  json.member("vehicle", name_of(vehicle));
  tell_vehicle(vehicle, [&](const std::string& name, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>) {
      json.key(name).exact(value);
    } else {
      json.member(name, value);
    }
  });
  tell_control_names(json, vehicle);
  tell_control_noise(json, vehicle, belief.control);
  tell_sensor(json, belief);
  json.member("association", known ? "known" : "nearest");
  json.key("gate").exact(setup.association.gate);
  json.key("new_gate").exact(setup.association.new_gate);
  json.member("landmarks", setup.landmarks);
  json.end_object();
}

}  // namespace

std::string start_message(std::uint64_t id, const RunStart& start, const FilterSetup& setup) {
  JsonWriter json = json_message(id, "start");
  json.member("run", start.run).member("seed", start.seed).key("start");
  exact_row(json, std::array{start.pose.x, start.pose.y, start.pose.heading});
  tell_settings(json, setup);
  return json.end_object().text();
}

std::string predict_message(std::uint64_t id, std::span<const ControlRow> controls) {
  JsonWriter json = json_message(id, "predict");
  tell_controls(json, controls);
  return json.end_object().text();
}

std::string scan_message(std::uint64_t id, std::span<const ControlRow> controls, Scan scan,
                         Association association, std::size_t components) {
  JsonWriter json = json_message(id, "scan");
  tell_controls(json, controls);
  json.key("detections").begin_array();
  for (const Detection& detection : scan) {
    const bool named = association == Association::known && detection.identity >= 0;
    json.begin_array();
    for (std::size_t i = 0; i < components; ++i) json.exact(detection[i]);
    json.value(named ? detection.identity : -1).end_array();
  }
  return json.end_array().end_object().text();
}

std::string map_message(std::uint64_t id) { return json_message(id, "map").end_object().text(); }

}  // namespace montecarta::experiments
