// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/slam_filter.hpp"
#include "filters/models/vehicle.hpp"

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta {

/// What the filter believes about vehicle and sensor (study file: [belief], default [scenario]).
struct Belief {
  Vehicle vehicle = {};
  double sigma_speed = 0.3;     ///< [m/s]
  double sigma_steer = 0.05;    ///< [rad]
  double sigma_range = 0.1;     ///< [m]
  double sigma_bearing = 0.02;  ///< [rad]
};

enum class Association { known, nearest };

/// Who decides which landmark a detection belongs to (study file: [association]; SPEC 17).
struct AssociationSettings {
  Association kind = Association::known;
  double gate = 5.991464547107979;  ///< chi-square, 2 dof: a detection nearer than this may match
  double new_gate = 25.0;           ///< farther than this from every landmark: a new one
  double log_new_density_offset = 0.0;  ///< added to log p0 of SPEC 17 [D]
  std::size_t most_landmarks = 1000;  ///< a map that grows beyond this has run away: the run fails
};

/// One setting of a filter, as a user types it behind the filter's name in a cell line.
struct FilterOption {
  enum class Kind { number, integer, choice };
  std::string name;
  Kind kind = Kind::number;
  std::string fallback;  ///< default value, as text
  double least = 0.0;    ///< of numbers and integers, inclusive
  double most = 0.0;
  std::vector<std::string> choices;  ///< of Kind::choice
  std::string meaning;               ///< one line, with unit and equation
};

/// Values of a filter's options, checked against their FilterOption beforehand.
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
  bool has_mixture = false;   ///< whether estimate() carries a mixture
  bool has_joint = false;     ///< whether joint() gives anything
  std::vector<FilterOption> options;  ///< in the order in which they are documented
  std::function<std::unique_ptr<SlamFilter>(const FilterSetup&)> make;
};

/// All filters, in the order in which they are listed.
std::span<const FilterKind> filter_kinds();

}  // namespace montecarta
