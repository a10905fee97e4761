// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The kind of state that an estimator estimates.
enum class StateKind {
  /// Pose in the plane: x_m, y_m, heading_rad, which may also be called yaw, theta, psi or phi.
  pose,
  /// x_m, y_m, z_m and the quaternion qx, qy, qz, qw, which have six components of the error; then,
  /// if there are, the velocity vx_mps, vy_mps, vz_mps in the map, and any other columns.
  pose_in_space,
  vector  ///< any other state, in R^n
};
/// The state described by the header of a file of estimates.
struct StateShape {
  StateKind kind = StateKind::vector;
  std::vector<std::string> columns;     ///< {width} names of the state, in the order of StateRows
  std::vector<std::string> components;  ///< {d} names of the error, without units: "x", "rx"
  std::vector<std::string> units;       ///< {d} "m", "rad", ...; "1" if the header has no unit
  bool wraps = true;                    ///< whether angles are the same after a full turn

  std::size_t width() const { return columns.size(); }
  std::size_t dimension() const { return components.size(); }
  bool operator==(const StateShape&) const = default;
};

/// Indices of the fields in a row of a file of estimates.
struct EstimateFields {
  StateShape shape;
  std::vector<std::size_t> state;  ///< {width} fields of the state
  /// {d, d} fields; if the file has only a triangle, most occur twice. kNoField where the file has
  /// no covariance between two blocks, which counts as 0.
  std::vector<std::size_t> covariance;
  static constexpr std::size_t kNoField = static_cast<std::size_t>(-1);
  bool are_deviations = false;  ///< whether the diagonal has standard deviations
  /// Which covariances the file does not have, in words; empty if it has all.
  std::string uncorrelated = {};
  std::optional<std::size_t> nis, nis_dof;  ///< both are present or neither
  std::optional<std::size_t> sensor = {};   ///< of a row of innovations: the name of its sensor
};

/// Name of the first column of every file.
inline const std::string kTimeColumn = "time_s";

/// Prefix of the columns of a truth in a file of estimates.
inline const std::string kTruthPrefix = "true_";
/// Prefix of columns that are errors, and not estimates.
inline const std::string kErrorPrefix = "error_";

/// Width of a pose in space, and the number of its components. Other columns of the state, and
/// their components, follow.
inline constexpr Eigen::Index kPoseWidth = 7, kPoseComponents = 6;

}  // namespace montecarta::experiments
