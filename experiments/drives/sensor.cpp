// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/sensor.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

StreamIdentity with(StreamIdentity place, Draw purpose, std::int32_t index) {
  place.purpose = purpose;
  place.index = static_cast<std::uint32_t>(index);
  return place;
}

/// Poisson by multiplying uniforms (Knuth); `mean` is a few per scan.
std::uint32_t poisson(double mean, RngStream& draw) {
  const double limit = std::exp(-mean);
  std::uint32_t count = 0;
  for (double product = draw.uniform(); product > limit; product *= draw.uniform()) ++count;
  return count;
}

}  // namespace

Sensor::Sensor(const Scenario& scenario)
    : view_(scenario.max_range, scenario.field_of_view),
      max_range_(scenario.max_range),
      field_of_view_(scenario.field_of_view),
      sigma_range_(scenario.sigma_range),
      sigma_bearing_(scenario.sigma_bearing),
      miss_probability_(scenario.miss_probability),
      clutter_rate_(scenario.clutter_rate) {}

void Sensor::detect(const VisibleLandmark& observation, const StreamIdentity& place,
                    std::vector<Detection>& detections) const {
  const bool missed =
      miss_probability_ > 0.0 &&
      RngStream(with(place, Draw::world_miss, observation.identity)).uniform() < miss_probability_;
  if (missed) return;
  RngStream draw(with(place, Draw::world_detection, observation.identity));
  const double range = observation.range + sigma_range_ * draw.normal();
  const double bearing = observation.bearing + sigma_bearing_ * draw.normal();
  detections.push_back({std::max(range, kLeastRange), wrap(bearing), observation.identity});
}

void Sensor::add_clutter(const StreamIdentity& place, std::vector<Detection>& detections) const {
  if (clutter_rate_ == 0.0) return;
  RngStream draw(with(place, Draw::world_clutter, 0));
  for (std::uint32_t left = poisson(clutter_rate_, draw); left > 0; --left) {
    const double range = max_range_ * std::sqrt(draw.uniform());
    const double bearing = field_of_view_ * (draw.uniform() - 0.5);
    detections.push_back({std::max(range, kLeastRange), wrap(bearing), Detection::kClutter});
  }
}

}  // namespace montecarta::experiments
