// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/namespaces.hpp"
#include "filters/models/parameter.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::filters {

/// Values of a filter's options, checked against their Parameter beforehand.
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

/// The enumerator at the place of `choice` among `choices`, which stand in the enumerators' order
/// and hold it: an option's value was checked before.
template <class Enumerator>
Enumerator chosen(const std::string& choice, const std::vector<std::string>& choices) {
  return static_cast<Enumerator>(std::find(choices.begin(), choices.end(), choice) -
                                 choices.begin());
}

/// What the filter believes about vehicle and sensor (study file: [belief], default [scenario]).
struct Belief {
  Vehicle vehicle = {};
  ControlNoise control{.sigma = {0.3, 0.05}};  ///< e.g. [m/s], [rad]
  double sigma_range = 0.1;                    ///< [m]
  double sigma_bearing = 0.02;                 ///< [rad]
  double sigma_forward = 0.1;                  ///< [m] of a position in the frame of the sensor
  double sigma_left = 0.1;                     ///< [m] likewise
  Sensor sensor = {};                          ///< whose components say which of these four count
};

enum class Association { known, nearest };

/// Who decides which landmark a detection belongs to (study file: [association]; EQUATIONS 17).
struct AssociationSettings {
  Association kind = Association::known;
  double gate = 5.991464547107979;  ///< chi-square of the detection: nearer than this it may match
  double new_gate = 25.0;           ///< farther than this from every landmark: a new one
  double log_new_density_offset = 0.0;  ///< added to log p0 of EQUATIONS 17
  std::size_t most_landmarks = 1000;  ///< a map that grows beyond this has run away: the run fails
};

/// Everything a filter is made of.
struct FilterSetup {
  Belief belief;
  AssociationSettings association;
  FilterOptions options;
  std::size_t landmarks = 0;  ///< of the world; an upper bound of identities with known association
};

/// A filter by name: one line in the table of factory.cpp.
struct FilterKind {
  std::string name;           ///< as users type it
  std::string long_name;      ///< for legends
  std::string source;         ///< paper and equation
  bool has_particles = true;  ///< whether it takes the option `particles` (always listed first)
  bool has_mixture = false;   ///< whether estimate() carries a mixture ...
  bool has_joint = false;     ///< whether joint() gives anything
  bool tells_rotation_information = false;  ///< where a detection fixes a landmark (ScanReport)
  bool has_map = true;                      ///< whether it initialises landmarks
  std::vector<Parameter> options;           ///< in the order in which they are documented
  /// Sensors that it takes, mounted at the pose; empty: all of them, wherever they are mounted.
  std::vector<std::string> sensors = {RangeBearingSensor::kName};
  /// Whether it initialises landmarks itself that one detection does not fix. It then needs to know
  /// which landmark a detection is of.
  bool delays_initialisation = false;
  std::function<bool(const FilterOptions&)> drops_mixture = {};  ///< ... but with these options
  std::function<std::unique_ptr<SlamFilter>(const FilterSetup&)> make;
};

}  // namespace montecarta::filters
