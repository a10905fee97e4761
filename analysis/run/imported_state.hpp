// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// State of cells that have innovations and no errors of a state. If their components are known,
/// they are stored as errors, those of predicted measurements.
inline constexpr const char* kInnovationsAlone = "innovations";

/// The quantity that another program estimates, with the convention of its error. All cells of a
/// file agree.
struct ImportedState {
  /// "pose", "pose in space", "vector" or kInnovationsAlone; empty for filters of this program.
  std::string state;
  std::string convention;  ///< name of the convention of the error, among kErrorConventions
  std::string windows;  ///< [s] lengths of the windows whose increments are judged; empty if none
  std::string moved;    ///< what was moved of the truths onto the first estimates; empty if nothing
  bool adds_truth_covariance = false;  ///< whether covariances of the truths were added
  /// The two estimators whose difference is judged, by the largest covariance that it can have;
  /// empty if errors are judged.
  std::string pair;
  std::vector<std::string> components = {"x", "y", "heading"};
  std::vector<std::string> units = {"m", "m", "rad"};

  bool is_imported() const { return !state.empty(); }
  bool are_innovations() const { return state == kInnovationsAlone; }
  /// Name of the whole whose error is judged: "pose", "state", "innovation", ...
  std::string name_of_whole() const;
  /// Name of the ratio of squared errors to the expected ones: "NEES ratio", or "NIS ratio".
  const char* name_of_ratio() const;
};

/// Components of a state that are also judged by themselves.
struct StateBlock {
  std::string name;                      ///< "position", "rotation", "heading" or "velocity"
  std::vector<Eigen::Index> components;  ///< indices, increasing
};

/// The blocks of a state whose components have these names and units, without one that is the whole
/// state: position x, y, z [m]; rotation rx, ry, rz or heading [rad]; velocity vx, vy, vz [mps].
std::vector<StateBlock> blocks_of(std::span<const std::string> components,
                                  std::span<const std::string> units);

/// The value of a setting; empty if there is none of this name.
std::string setting_of(const TextPairs& settings, const char* name);

/// Whether the covariances of a cell with these settings are only bounds from above: those of
/// pairs, of increments of corrected estimates, and of errors moved onto uncertain first estimates.
bool has_bounds(const TextPairs& settings);

/// The imported state from the settings of a cell if 'montecarta judge' made the file, else the
/// pose in the plane.
ImportedState imported_state(const StoredCell& cell);

/// Number of sensors of an estimator whose innovations are judged sensor by sensor; else 1.
std::size_t sensors_of(const ResultFile& file);

}  // namespace montecarta::analysis
