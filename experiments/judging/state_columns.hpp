// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The kind of state that an estimator estimates.
enum class StateKind {
  pose,           ///< pose in the plane: x_m, y_m, heading_rad
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

/// Estimates or truths of one run, as read from a file.
struct StateRows {
  StateShape shape;
  std::vector<double> time;            ///< [s] {row} time, increasing
  std::vector<Eigen::VectorXd> state;  ///< {row}{width}, quaternions of length 1
  /// {row}{d, d} covariance as in the file; empty for a truth.
  std::vector<Eigen::MatrixXd> covariance;
  std::vector<double> nis;  ///< {row} normalised innovation squared; empty if the file has none
  /// {row} number of components of each NIS; empty if the file has none.
  std::vector<std::uint32_t> nis_dof;
  std::uint64_t unwrapped_innovations = 0;  ///< number of innovations with an angle beyond pi
  std::string first_unwrapped = {};         ///< file and line of the first of them
};

/// Reads estimates (mean and covariance over time) from CSV. Throws StudyError with file, line and
/// remedy if the file is empty or damaged, or a number is not finite.
StateRows read_estimates(const std::filesystem::path& path);

/// Number of rows in a file.
std::size_t rows_in(const std::filesystem::path& path);

/// Reads a truth of the same state; other columns are ignored. Throws like read_estimates().
StateRows read_truth(const std::filesystem::path& path, const StateShape& shape);

/// The method that finds the truth at the time of an estimate.
struct TimeMatch {
  double tolerance = 1e-6;   ///< [s] largest difference of times that are the same
  bool interpolate = false;  ///< whether to interpolate linearly, with angles the shorter way round
};

/// The state of `truth` at `time`. Throws StudyError if there is none; the error names the files
/// `estimate` and `truths`.
Eigen::VectorXd truth_at(const StateRows& truth, double time, const TimeMatch& match,
                         const std::filesystem::path& estimate,
                         const std::filesystem::path& truths);

/// The file of innovations beside a file of estimates. Its name has `innovation` instead of
/// `estimate`, e.g. innovation_ekf.csv for estimate_ekf.csv. nullopt if it does not exist.
std::optional<std::filesystem::path> innovations_beside(const std::filesystem::path& estimates);

/// Reads innovations into `rows`, which holds the estimates of the file `estimates`. The file is
/// CSV with `time_s`, then either `nis,nis_dof`, or the components of the innovation and cov_A_B of
/// their covariance, as in a file of estimates. Rows with the same time are parts of one scan and
/// are added up. Estimates without a row have observed nothing. The NIS is NaN if the covariance is
/// not positive definite. Angles beyond pi are used as they are, and counted. Throws StudyError
/// with file, line and remedy, also if no estimate has the time of a row within `tolerance` [s].
void read_innovations(const std::filesystem::path& path, const std::filesystem::path& estimates,
                      double tolerance, StateRows& rows);

}  // namespace montecarta::experiments
