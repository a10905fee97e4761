// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/files/files.hpp"
#include "experiments/judging/state_shape.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// Name of a kind in a result file: "pose", "pose in space" or "vector".
std::string name_of(StateKind kind);

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
/// Whether a pose in space has a velocity, which follows the pose.
bool has_velocity(const StateShape& shape);

}  // namespace montecarta::experiments
