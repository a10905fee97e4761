// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The order in which a published drive says that its sensors spoke: one entry for each record of
/// the three sensor files.
struct SensorEvents {
  std::vector<double> time;    ///< [s]
  std::vector<double> sensor;  ///< 1 GPS, 2 dead reckoning, 3 laser
  std::vector<double> index;   ///< of the record in the sensor's file, from 1
};

/// Times [s] of the records of sensors 1, 2 and 3; empty where that sensor's file was not read.
using SensorTimes = std::array<std::span<const double>, 3>;

/// Throws StudyError (`place` is the file of the events) unless the events name every record of
/// every sensor that was read once, in order and with its time: that finds records that are
/// missing, left over or out of order where a sensor's file alone still looks whole.
void check_events(const SensorEvents& events, const SensorTimes& times, const std::string& place);

}  // namespace montecarta::experiments
