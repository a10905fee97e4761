// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/sensor_events.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <cmath>
#include <cstddef>

namespace montecarta::experiments {
namespace {

constexpr double kRounding = 0.0006;  ///< [s] times are published in whole milliseconds
constexpr std::array<const char*, 3> kSensors = {"GPS", "odometry", "laser"};

[[noreturn]] void refuse(const std::string& place, const std::string& fault) {
  throw StudyError(place + ": " + fault +
                   " (the list and the sensors' files must be of one drive): take all files as " +
                   "published");
}

/// 0, 1 or 2 for GPS, odometry, laser.
std::size_t sensor_of(double number, const std::string& place) {
  if (number == 1.0 || number == 2.0 || number == 3.0) return static_cast<std::size_t>(number) - 1;
  refuse(place, "sensor " + to_text(number) + " is none of 1, 2, 3");
}

void check_event(double time, double index, std::span<const double> times, std::size_t expected,
                 const std::string& place) {
  const bool fits = index == static_cast<double>(expected + 1) && expected < times.size() &&
                    std::abs(times[expected] - time) <= kRounding;
  if (fits) return;
  refuse(place, "record " + to_text(index) + " at " + to_text(time) +
                    " s is not the next of that sensor's file, " + std::to_string(expected + 1) +
                    (expected < times.size() ? " at " + to_text(times[expected]) + " s"
                                             : " of " + std::to_string(times.size())));
}

}  // namespace

void check_events(const SensorEvents& events, const SensorTimes& times, const std::string& place) {
  const std::size_t count = events.time.size();
  if (events.sensor.size() != count || events.index.size() != count) {
    refuse(place, "as many sensors and indices as times are needed");
  }
  std::array<std::size_t, 3> seen = {};
  for (std::size_t i = 0; i < count; ++i) {
    const std::string at = place + ": record " + std::to_string(i + 1);
    const std::size_t sensor = sensor_of(events.sensor[i], at);
    if (times[sensor].empty()) continue;
    check_event(events.time[i], events.index[i], times[sensor], seen[sensor]++,
                at + " (" + kSensors[sensor] + ")");
  }
  for (std::size_t sensor = 0; sensor < times.size(); ++sensor) {
    if (times[sensor].empty() || seen[sensor] == times[sensor].size()) continue;
    refuse(place, std::to_string(seen[sensor]) + " of " + std::to_string(times[sensor].size()) +
                      " records of " + kSensors[sensor] + " are listed");
  }
}

}  // namespace montecarta::experiments
