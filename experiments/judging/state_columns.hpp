// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/files/files.hpp"

#include <Eigen/Core>

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
  pose_in_space,  ///< x_m, y_m, z_m and the quaternion qx, qy, qz, qw; its error has six components
  vector          ///< any other state, in R^n
};
/// Name of a kind in a result file: "pose", "pose in space" or "vector".
std::string name_of(StateKind kind);

/// The state described by the header of a file of estimates.
struct StateShape {
  StateKind kind = StateKind::vector;
  std::vector<std::string> columns;     ///< {width} names of the state, in the order of StateRows
  std::vector<std::string> components;  ///< {d} names of the error, without units: "x", "rx"
  std::vector<std::string> units;       ///< {d} "m", "rad", ...; "1" if the header has no unit

  std::size_t width() const { return columns.size(); }
  std::size_t dimension() const { return components.size(); }
  bool operator==(const StateShape&) const = default;
};

/// Indices of the fields in a row of a file of estimates.
struct EstimateFields {
  StateShape shape;
  std::vector<std::size_t> state;  ///< {width} fields of the state
  /// {d, d} fields; if the file has only a triangle, most occur twice.
  std::vector<std::size_t> covariance;
  std::optional<std::size_t> nis, nis_dof;  ///< both are present or neither
};

/// Name of the first column of every file.
inline const std::string kTimeColumn = "time_s";

/// Parses the header of estimates: `time_s`, the state, then `cov_A_B`, where A and B are names of
/// components or indices from 0, for the whole covariance or one triangle, and optionally `nis` and
/// `nis_dof`. Throws StudyError that begins with `place`.
EstimateFields estimate_fields(const std::vector<std::string>& header, const std::string& place);

/// Parses the header of innovations: `time_s`, then either `nis` and `nis_dof`, which leave the
/// other fields empty, or the components of the innovation and their covariance as in a header of
/// estimates. Throws StudyError that begins with `place`.
EstimateFields innovation_fields(const std::vector<std::string>& header, const std::string& place);

/// Indices of the state's fields in the header of a truth, which may have further columns. Throws
/// StudyError that begins with `place`.
std::vector<std::size_t> truth_fields(const std::vector<std::string>& header,
                                      const StateShape& shape, const std::string& place);

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

/// Normalises the quaternion at the end of the state of a pose in space.
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

}  // namespace montecarta::experiments
