// SPDX-License-Identifier: BSD-3-Clause
// A replay as the page's player reads it.
#include "analysis/output/figure.hpp"
#include "analysis/page/html.hpp"
#include "analysis/page/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace montecarta::analysis {
namespace {

constexpr int kPlaceDigits = 6;  // a millimetre in 300 m
constexpr int kSizeDigits = 3;
constexpr int kAngleDigits = 2;

Json json_of(const std::vector<std::pair<double, double>>& points) {
  Json array = Json::array();
  for (const auto& [x, y] : points) {
    array.push_back(rounded(x));
    array.push_back(rounded(y));
  }
  return array;
}

/// Diameters [m] and angle [deg].
void add_size(const Ellipse& e, Json& array) {
  array.push_back(rounded(e.major, kSizeDigits));
  array.push_back(rounded(e.minor, kSizeDigits));
  array.push_back(rounded(e.angle, kAngleDigits));
}

/// Numbers from 0 on as digits of base 64, which take a third of the room of decimal ones.
void add_digits(double number, int count, std::string& text) {
  constexpr std::string_view kDigits =
      "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-_";
  auto rest = static_cast<unsigned>(number);
  std::string digits(static_cast<std::size_t>(count), '0');
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit, rest /= 64) {
    *digit = kDigits[rest % 64];
  }
  text += digits;
}

/// Two digits: 1 is `size` below, 4095 as much above; 0 where it is no number.
void add_place(double offset, double size, std::string& text) {
  const double share = std::round(2047.0 * offset / size);
  add_digits(std::abs(share) <= 2047.0 ? 2048.0 + share : 0.0, 2, text);
}

/// [m] The greatest distance from the estimate along an axis.
double reach_of(const ReplayParticles::Frame& frame, double x, double y) {
  double size = 0.0;
  for (std::size_t i = 0; i < frame.x.size(); ++i) {
    for (const double offset : {std::abs(frame.x[i] - x), std::abs(frame.y[i] - y)}) {
      if (std::isfinite(offset)) size = std::max(size, offset);
    }
  }
  return 1.0001 * size + 1e-9;
}

/// Each particle: x and y by the estimate, four digits; its parent, two; the root of its
/// weight, as dark as it is drawn, one.
Json json_of(const ReplayParticles::Frame& frame, double x, double y) {
  const double size = reach_of(frame, x, y);
  std::string dots, parents, weights;
  for (std::size_t i = 0; i < frame.x.size(); ++i) {
    add_place(frame.x[i] - x, size, dots);
    add_place(frame.y[i] - y, size, dots);
  }
  for (const std::uint32_t parent : frame.parent) add_digits(parent, 2, parents);
  for (const double weight : frame.weight) {
    add_digits(weight > 0.0 ? std::round(63.0 * std::sqrt(weight)) : 0.0, 1, weights);
  }
  Json json = {{"size", rounded(size)}, {"dots", dots}};
  if (!parents.empty()) json["parent"] = parents;
  if (!weights.empty()) json["weight"] = weights;
  return json;
}

void add_particles(const ReplayCell& cell, Json& json) {
  json["particles"] = cell.particles.all;
  Json& clouds = json["clouds"] = Json::array();
  for (std::size_t f = 0; f < cell.particles.frames.size(); ++f) {
    clouds.push_back(json_of(cell.particles.frames[f], cell.x[f], cell.y[f]));
  }
}

/// Row, centre [m], diameters [m] and angle [deg], six numbers a landmark.
Json json_of(const ReplayMap& map) {
  Json landmarks = Json::array();
  for (const auto& [row, ellipse] : map.changed) {
    landmarks.push_back(row);
    landmarks.push_back(rounded(ellipse.x));
    landmarks.push_back(rounded(ellipse.y));
    add_size(ellipse, landmarks);
  }
  return {{"frame", map.frame}, {"landmarks", std::move(landmarks)}};
}

void add_path(const std::vector<double>& x, const std::vector<double>& y,
              const std::vector<double>& h, Json& json) {
  json["x"] = rounded(x, kPlaceDigits);
  json["y"] = rounded(y, kPlaceDigits);
  json["h"] = rounded(h, kSizeDigits + 1);
}

Json json_of(const ReplayCell& cell) {
  Json json = {{"label", cell.label},
               {"failure", cell.failure},
               {"colour", line_colour(cell.style)},
               {"ancestry", cell.has_ancestry}};
  add_path(cell.x, cell.y, cell.h, json);
  Json& pose = json["pose"] = Json::array();
  for (const Ellipse& e : cell.pose) add_size(e, pose);
  json["nees"] = rounded(cell.nees, kSizeDigits);
  json["band"] = {rounded(cell.nees_band.lower), rounded(cell.nees_band.upper)};
  add_particles(cell, json);
  Json& maps = json["maps"] = Json::array();
  for (const ReplayMap& map : cell.maps) maps.push_back(json_of(map));
  return json;
}

}  // namespace

std::string replay_json(const Replay& replay) {
  Json json = {{"run", replay.run},
               {"close_up", rounded(replay.close_up)},
               {"times", rounded(replay.times, kPlaceDigits)}};
  json["truth"] = Json::object();
  add_path(replay.x, replay.y, replay.h, json["truth"]);
  json["landmarks"] = json_of(replay.landmarks);
  json["fixes"] = json_of(replay.fixes);
  Json& cells = json["cells"] = Json::array();
  for (const ReplayCell& cell : replay.cells) cells.push_back(json_of(cell));
  return script_text(json);
}

}  // namespace montecarta::analysis
