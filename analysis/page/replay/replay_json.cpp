// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/figure.hpp"
#include "analysis/page/json.hpp"
#include "analysis/page/replay/replay.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr int kPlaceDigits = 6;  // a millimetre in 300 m
constexpr int kSizeDigits = 3;

void write_numbers(const char* name, const std::vector<double>& values, int digits,
                   JsonWriter& json) {
  json.key(name).begin_array();
  for (const double value : values) json.value(value, digits);
  json.end_array();
}

void write_points(const char* name, const std::vector<std::pair<double, double>>& points,
                  JsonWriter& json) {
  json.key(name).begin_array();
  for (const auto& [x, y] : points) json.value(x).value(y);
  json.end_array();
}

/// Diameters [m] and angle [deg], three numbers each; the centre is the pose.
void write_pose_ellipses(const std::vector<Ellipse>& ellipses, JsonWriter& json) {
  json.key("pose").begin_array();
  for (const Ellipse& e : ellipses) {
    for (const double value : {e.major, e.minor, e.angle}) json.value(value, kSizeDigits);
  }
  json.end_array();
}

/// Places relative to the estimate in whole units, which are short to write.
void write_places(const char* name, const std::vector<double>& places, double centre, double unit,
                  JsonWriter& json) {
  json.key(name).begin_array();
  for (const double place : places) {
    json.value(std::isfinite(place) ? std::round((place - centre) / unit) : place, 9);
  }
  json.end_array();
}

/// A power of ten [m], a hundred thousandth of the greatest coordinate or less.
double unit_of(const ReplayCell& cell) {
  double greatest = 1.0;
  for (const auto* values : {&cell.x, &cell.y}) {
    for (const double value : *values) {
      if (std::isfinite(value)) greatest = std::max(greatest, std::abs(value));
    }
  }
  return std::pow(10.0, std::floor(std::log10(greatest)) - 5.0);
}

void write_particles(const ReplayCell& cell, JsonWriter& json) {
  const double unit = unit_of(cell);
  json.member("particles", cell.particles.all).member("unit", unit);
  json.key("clouds").begin_array();
  for (std::size_t f = 0; f < cell.particles.frames.size(); ++f) {
    const ReplayParticles::Frame& frame = cell.particles.frames[f];
    json.begin_object();
    write_places("x", frame.x, cell.x[f], unit, json);
    write_places("y", frame.y, cell.y[f], unit, json);
    if (!frame.parent.empty()) json.member("parent", frame.parent);
    json.end_object();
  }
  json.end_array();
}

/// Centre [m], diameters [m] and angle [deg], five numbers a landmark.
void write_maps(const std::vector<ReplayMap>& maps, JsonWriter& json) {
  json.key("maps").begin_array();
  for (const ReplayMap& map : maps) {
    json.begin_object().member("frame", map.frame).key("landmarks").begin_array();
    for (const Ellipse& e : map.landmarks) {
      json.value(e.x).value(e.y);
      for (const double value : {e.major, e.minor, e.angle}) json.value(value, kSizeDigits);
    }
    json.end_array().end_object();
  }
  json.end_array();
}

void write_path(const std::vector<double>& x, const std::vector<double>& y,
                const std::vector<double>& h, JsonWriter& json) {
  write_numbers("x", x, kPlaceDigits, json);
  write_numbers("y", y, kPlaceDigits, json);
  write_numbers("h", h, kSizeDigits + 1, json);
}

void write_cell(const ReplayCell& cell, JsonWriter& json) {
  json.begin_object().member("label", cell.label).member("failure", cell.failure);
  json.member("colour", line_colour(cell.style)).member("ancestry", cell.has_ancestry);
  write_path(cell.x, cell.y, cell.h, json);
  write_pose_ellipses(cell.pose, json);
  write_particles(cell, json);
  write_maps(cell.maps, json);
  json.end_object();
}

}  // namespace

std::string replay_json(const Replay& replay) {
  JsonWriter json;
  json.begin_object().member("run", replay.run);
  write_numbers("times", replay.times, kPlaceDigits, json);
  json.key("truth").begin_object();
  write_path(replay.x, replay.y, replay.h, json);
  json.end_object();
  write_points("landmarks", replay.landmarks, json);
  write_points("fixes", replay.fixes, json);
  json.key("cells").begin_array();
  for (const ReplayCell& cell : replay.cells) write_cell(cell, json);
  return json.end_array().end_object().text();
}

}  // namespace montecarta::analysis
