// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/namespaces.hpp"
#include "filters/models/parameter.hpp"
#include "filters/models/sensor_kinds.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace montecarta::filters {

struct FilterSetup;

/// A filter by name, one line in the table of factory.cpp.
struct FilterKind {
  std::string name;       ///< name in study files
  std::string long_name;  ///< name in legends
  std::string source;     ///< paper and equation
  /// Data that the filter reports. If it has particles, its first option is `particles`.
  Capabilities reports = {};
  std::vector<Parameter> options;  ///< options in the order of the documentation
  /// Sensors that it supports, mounted at the pose; empty means all sensors, mounted anywhere.
  std::vector<std::string> sensors = {RangeBearingSensor::kName};
  bool takes_mountings = false;  ///< true if its listed sensors may be mounted anywhere, too
  /// True if it initialises landmarks that one detection does not fix. It then needs known
  /// association.
  bool delays_initialisation = false;
  bool takes_prior = false;  ///< true if it can be started from a Prior, with a known map
  bool takes_fixes = false;  ///< true if it uses fixes of the position (take_fix())
  /// Removes from the capabilities those that the filter does not have with this setup; empty: it
  /// has all.
  std::function<void(const FilterSetup&, Capabilities&)> restrict_reports = {};
  std::function<std::unique_ptr<SlamFilter>(const FilterSetup&)> make;
};

}  // namespace montecarta::filters
