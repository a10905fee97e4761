// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// State of cells that have innovations and no errors.
inline constexpr const char* kInnovationsAlone = "innovations";

/// The quantity that another program estimates, with the convention of its error. All cells of a
/// file agree.
struct ImportedState {
  /// "pose", "pose in space", "vector" or kInnovationsAlone; empty for filters of this program.
  std::string state;
  std::string convention;  ///< convention of the error: "world", "body" or "right-invariant"
  std::vector<std::string> components = {"x", "y", "heading"};
  std::vector<std::string> units = {"m", "m", "rad"};

  bool is_imported() const { return !state.empty(); }
};

/// The imported state from the settings of a cell if 'montecarta judge' made the file, else the
/// pose in the plane.
ImportedState imported_state(const StoredCell& cell);

}  // namespace montecarta::analysis
