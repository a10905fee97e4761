// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace montecarta::engine {

class SlamFilter;

/// A number of every scan that only some filters report. The filter declares it here and reports
/// its value in ScanReport::own.
struct OwnColumn {
  std::string name;   ///< as in the file, and in no other column's row of records/columns.cpp
  std::string group;  ///< group of record.columns that stores it; those of "pose" always are
  std::string units;  ///< UDUNITS style: "m", "rad", "1"
  std::string long_name;
};

/// The estimates of a filter besides the spread of its pose. The filter declares them; a study
/// stores the columns of a mixture, a joint estimate or the filter's own if they are there.
struct Capabilities {
  bool particles = false;
  bool mixture = false;                     ///< estimate() has a mixture before sampling
  bool joint = false;                       ///< joint() has an estimate
  bool map = true;                          ///< map() has landmarks
  std::vector<OwnColumn> own_columns = {};  ///< in the order of ScanReport::own
};

}  // namespace montecarta::engine
