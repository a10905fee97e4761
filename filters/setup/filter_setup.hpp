// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::filters {

/// Values of a filter's options, which have been checked against their Parameter.
class FilterOptions {
 public:
  explicit FilterOptions(std::map<std::string, std::string, std::less<>> values)
      : values_(std::move(values)) {}
  double number(std::string_view name) const;
  std::size_t integer(std::string_view name) const;
  const std::string& choice(std::string_view name) const;

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

/// The enumerator at the position of `choice` in `choices`, which must contain it and be in the
/// order of the enumerators.
template <class Enumerator>
Enumerator chosen(const std::string& choice, const std::vector<std::string>& choices) {
  return static_cast<Enumerator>(std::find(choices.begin(), choices.end(), choice) -
                                 choices.begin());
}

/// The model that a filter has of vehicle and sensor (study file: [belief], default [scenario]).
struct Belief {
  Vehicle vehicle = {};
  ControlNoise control{.sigma = {0.3, 0.05}};  ///< noise of the controls, for instance [m/s], [rad]
  double sigma_range = 0.1;                    ///< [m] standard deviation of a range
  double sigma_bearing = 0.02;                 ///< [rad] standard deviation of a bearing
  double sigma_forward = 0.1;  ///< [m] standard deviation of a position, forward of the sensor
  double sigma_left = 0.1;     ///< [m] standard deviation of a position, left of the sensor
  Sensor sensor = {};          ///< its components determine which of the four above are used
  /// [m] standard deviation of a fix of the position, in x and in y; nullopt if there are none.
  std::optional<double> sigma_fix = {};
};

enum class Association { known, nearest };

/// The association of detections with landmarks (study file: [association]; EQUATIONS 17).
struct AssociationSettings {
  Association kind = Association::known;
  double gate = 5.991464547107979;      ///< D^2 below which a detection may match
  double new_gate = 25.0;               ///< D^2 to all landmarks beyond which a detection is new
  double log_new_density_offset = 0.0;  ///< added to log p0 of EQUATIONS 17
  std::size_t most_landmarks = 1000;    ///< largest size of a map; the run fails if a map has more
};

/// All inputs of which a filter is made.
struct FilterSetup {
  Belief belief;
  AssociationSettings association;
  FilterOptions options;
  /// Number of landmarks in the world; bounds identities with known association.
  std::size_t landmarks = 0;
  /// True if the filter is started from a Prior with a map.
  bool map_is_known = false;
};

}  // namespace montecarta::filters
