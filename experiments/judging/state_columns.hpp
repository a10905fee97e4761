// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/files/files.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
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
/// Name of a kind in a result file: "pose", "pose in space" or "vector".
std::string name_of(StateKind kind);

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

/// Parses the header of estimates: `time_s`, the state, then `cov_A_B`, where A and B are names of
/// components or indices from 0, for the whole covariance, one triangle of it, or blocks between
/// which there is none, or `sigma_A`, the standard deviations alone; and optionally `nis` and
/// `nis_dof`. Columns of a truth are ignored. Errors have the components of what they are errors
/// of. Throws StudyError that begins with `place`.
EstimateFields estimate_fields(const std::vector<std::string>& header, const std::string& place);

/// Parses the header of innovations: `time_s`, then either `nis` and `nis_dof`, which leave the
/// other fields empty, or the components of the innovation and their covariance as in a header of
/// estimates; and optionally `sensor`. Throws StudyError that begins with `place`.
EstimateFields innovation_fields(const std::vector<std::string>& header, const std::string& place);

/// Prefix of the columns of a truth in a file of estimates.
inline const std::string kTruthPrefix = "true_";
/// Prefix of columns that are errors, and not estimates.
inline const std::string kErrorPrefix = "error_";

/// What a file of estimates has in place of a truth in a file of its own.
enum class OwnTruth {
  none,
  columns,  ///< a column true_C for each column C of the state, and true_cov_A_B if it has errors
  errors    ///< every column of the state is an error, named error_C
};
/// Throws StudyError that begins with `place` if a header has a part of either.
OwnTruth own_truth_in(const std::vector<std::string>& header, const std::string& place);

/// The fields of the state in the header of a truth, which may have further columns, and of its
/// covariance if it is wanted. The names of columns begin with `prefix`. Throws StudyError that
/// begins with `place`.
EstimateFields truth_fields(const std::vector<std::string>& header, const StateShape& shape,
                            const std::string& place, const std::string& prefix = "",
                            bool with_covariance = false);

/// The state {width} in the current row. Throws StudyError if a number is not finite or a
/// quaternion is not of a rotation.
Eigen::VectorXd state_in(const CsvRows& rows, const std::vector<std::size_t>& fields,
                         const StateShape& shape);

/// The covariance {d, d} in the current row, as in the file. Throws StudyError if a number is not
/// finite.
Eigen::MatrixXd covariance_in(const CsvRows& rows, const EstimateFields& fields);

/// The NIS of the current row and its number of components. Throws StudyError if they are given and
/// are no sum of squares and its count.
std::pair<double, std::uint32_t> nis_in(const CsvRows& file, const EstimateFields& fields);

/// The rotation in the state of a pose in space.
Eigen::Quaterniond quaternion_in(const Eigen::VectorXd& state);

/// Normalises the quaternion in the state of a pose in space.
void normalise_quaternion(Eigen::VectorXd& state, const std::string& place);

/// The number of components of a NIS. Throws StudyError that begins with `place` if `nis` is not a
/// sum of squares or `dof` is not a count.
std::uint32_t checked_dof(double nis, double dof, const std::string& place);

/// Whether element `k` of a state is an angle, which is the same after a full turn.
bool is_angle(const StateShape& shape, Eigen::Index k);

/// For a vector with x_m, y_m and an angle, which may be meant as a pose: its columns, and what
/// they lack to be one. Empty for other states.
std::string likeness_to_pose(const StateShape& shape);

/// Index of the quaternion in the state of a pose in space, behind x, y, z.
inline constexpr Eigen::Index kQuaternionPlace = 3;
/// Width of a pose in space, and the number of its components. Other columns of the state, and
/// their components, follow.
inline constexpr Eigen::Index kPoseWidth = 7, kPoseComponents = 6;
/// Whether a pose in space has a velocity, which follows the pose.
bool has_velocity(const StateShape& shape);

}  // namespace montecarta::experiments
