// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// What estimates of another program are of; all cells of a file agree.
struct ImportedState {
  std::string state;       ///< "pose", "pose in space" or "vector"; empty: filters of ours
  std::string convention;  ///< of the error: "world", "body" or "right-invariant"
  std::vector<std::string> components = {"x", "y", "heading"};
  std::vector<std::string> units = {"m", "m", "rad"};

  bool is_imported() const { return !state.empty(); }
};

/// The imported state by the settings of a cell, if 'montecarta judge' made the file; else the pose
/// in the plane.
ImportedState imported_state(const StoredCell& cell);

}  // namespace montecarta::analysis
