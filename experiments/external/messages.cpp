// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/messages.hpp"

#include "analysis/page/json.hpp"

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

void tell_settings(JsonWriter& json, const FilterSetup& setup) {
  const auto& [vehicle, sigma_speed, sigma_steer, sigma_range, sigma_bearing] = setup.belief;
  const bool front = vehicle.kind == Vehicle::Kind::front_axle;
  const bool known = setup.association.kind == Association::known;
  json.key("settings").begin_object();
  json.member("vehicle", front ? "front_axle" : "rear_wheel");
  json.key("wheelbase").exact(vehicle.wheelbase);
  json.key("wheel_left").exact(vehicle.wheel_left);
  json.key("sensor_ahead").exact(vehicle.sensor_ahead);
  json.key("sensor_left").exact(vehicle.sensor_left);
  json.key("sigma_speed").exact(sigma_speed);
  json.key("sigma_steer").exact(sigma_steer);
  json.key("sigma_range").exact(sigma_range);
  json.key("sigma_bearing").exact(sigma_bearing);
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
                         Association association) {
  JsonWriter json = json_message(id, "scan");
  tell_controls(json, controls);
  json.key("detections").begin_array();
  for (const Detection& detection : scan) {
    const bool named = association == Association::known && detection.identity >= 0;
    json.begin_array().exact(detection.range).exact(detection.bearing);
    json.value(named ? detection.identity : -1).end_array();
  }
  return json.end_array().end_object().text();
}

std::string map_message(std::uint64_t id) { return json_message(id, "map").end_object().text(); }

}  // namespace montecarta::experiments
