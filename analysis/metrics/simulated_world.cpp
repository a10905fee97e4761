// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/simulated_world.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

namespace montecarta::analysis {
namespace {

/// Settings of a scenario by name; notes whether all that was asked for is there.
class Facts {
 public:
  explicit Facts(const TextPairs& pairs) : pairs_(&pairs) {}

  std::string_view text(std::string_view name) {
    const auto found =
        std::ranges::find_if(*pairs_, [&](const auto& p) { return p.first == name; });
    if (found != pairs_->end()) return found->second;
    complete_ = false;
    return {};
  }
  double number(std::string_view name) {
    const std::string_view written = text(name);
    double value = 0.0;
    const auto end = written.data() + written.size();
    complete_ = complete_ && std::from_chars(written.data(), end, value).ptr == end;
    return value;
  }
  double radians(std::string_view name) { return number(name) / 180.0 * kPi; }
  bool complete() const { return complete_; }

 private:
  const TextPairs* pairs_;
  bool complete_ = true;
};

Vehicle vehicle_of(Facts& facts) {
  return {.kind = facts.text("vehicle") == "rear_wheel" ? Vehicle::Kind::rear_wheel
                                                        : Vehicle::Kind::front_axle,
          .wheelbase = facts.number("wheelbase"),
          .wheel_left = facts.number("wheel_left"),
          .sensor_ahead = facts.number("sensor_ahead"),
          .sensor_left = facts.number("sensor_left")};
}

}  // namespace

std::optional<SimulatedWorld> simulated_world_of(const ResultFile& file) {
  Facts facts(file.scenario());
  if (facts.text("kind") != "simulated" || !file.has_truth()) return std::nullopt;
  SimulatedWorld world{
      .vehicle = vehicle_of(facts),
      .sigma_control = {facts.number("sigma_speed"), facts.radians("sigma_steer_deg")},
      .sigma_observation = {facts.number("sigma_range"), facts.radians("sigma_bearing_deg")},
      .detected = 1.0 - facts.number("miss_probability"),
      .view = FieldOfView(facts.number("max_range"), facts.radians("field_of_view_deg")),
      .same_path = facts.text("noise") != "matched"};
  if (!facts.complete()) return std::nullopt;
  return world;
}

}  // namespace montecarta::analysis
