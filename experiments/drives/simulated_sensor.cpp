// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/drives/simulated_sensor.hpp"

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

SimulatedSensor::SimulatedSensor(const Scenario& scenario)
    : sensor_(scenario.sensor),
      sigma_(deviations_of(scenario.sensor, scenario)),
      view_(scenario.max_range, scenario.field_of_view, scenario.sensor.mounting,
            scenario.min_range),
      min_range_(scenario.min_range),
      max_range_(scenario.max_range),
      field_of_view_(scenario.field_of_view),
      miss_probability_(scenario.miss_probability),
      clutter_rate_(scenario.clutter_rate) {}

/// A detection with noise, if there is any, of values that the sensor can have.
Detection SimulatedSensor::noisy(const Eigen::Vector2d& exact, std::int32_t identity,
                                 RngStream* noise) const {
  Detection detection{.values = {}, .identity = identity};
  std::size_t i = 0;
  for (const Quantity quantity : components_of(sensor_)) {
    const auto at = static_cast<Eigen::Index>(i);
    double value = exact(at);
    if (noise != nullptr) value += sigma_(at) * noise->normal();
    if (quantity == Quantity::range) value = std::max(value, kLeastRange);
    detection[i++] = is_angle(quantity) ? wrap(value) : value;
  }
  return detection;
}

void SimulatedSensor::detect(const VisibleLandmark& observation, const StreamIdentity& place,
                             std::vector<Detection>& detections) const {
  const bool missed =
      miss_probability_ > 0.0 &&
      RngStream(with(place, Draw::world_miss, observation.identity)).uniform() < miss_probability_;
  if (missed) return;
  RngStream draw(with(place, Draw::world_detection, observation.identity));
  detections.push_back(noisy(observation.detection, observation.identity, &draw));
}

void SimulatedSensor::add_clutter(const StreamIdentity& place,
                                  std::vector<Detection>& detections) const {
  if (clutter_rate_ == 0.0) return;
  RngStream draw(with(place, Draw::world_clutter, 0));
  for (std::uint32_t left = poisson(clutter_rate_, draw); left > 0; --left) {
    const double share = draw.uniform(), inner = min_range_ / max_range_;
    const double range = max_range_ * std::sqrt(share + (1.0 - share) * inner * inner);
    const double bearing = field_of_view_ * (draw.uniform() - 0.5);
    const Eigen::Vector2d exact = detection_of(sensor_, {range, bearing});
    detections.push_back(noisy(exact, Detection::kClutter, nullptr));
  }
}

}  // namespace montecarta::experiments
