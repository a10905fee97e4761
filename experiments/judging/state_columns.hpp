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

/// What an estimator estimates.
enum class StateKind {
  pose,           ///< in the plane: x_m, y_m, heading_rad
  pose_in_space,  ///< x_m, y_m, z_m and the quaternion qx, qy, qz, qw; its error has six components
  vector          ///< anything else, in R^n
};
/// "pose", "pose in space" or "vector", as a result file has it.
std::string name_of(StateKind kind);

/// The state in the header of a file of estimates.
struct StateShape {
  StateKind kind = StateKind::vector;
  std::vector<std::string> columns;     ///< {width} of the state, in the order of StateRows
  std::vector<std::string> components;  ///< {d} of the error, without units: "x", "rx"
  std::vector<std::string> units;       ///< {d} "m", "rad", ...; "1" where the header names none

  std::size_t width() const { return columns.size(); }
  std::size_t dimension() const { return components.size(); }
  bool operator==(const StateShape&) const = default;
};

/// Where a file has what: fields of a row.
struct EstimateFields {
  StateShape shape;
  std::vector<std::size_t> state;           ///< {width}
  std::vector<std::size_t> covariance;      ///< {d, d}; of a triangle each element stands twice
  std::optional<std::size_t> nis, nis_dof;  ///< both or none
};

/// Understands the header of estimates: `time_s`, the state, then `cov_A_B` with names of
/// components or indices from 0, the whole covariance or one triangle; perhaps `nis` and `nis_dof`.
/// Throws StudyError beginning
/// with `place`.
EstimateFields estimate_fields(const std::vector<std::string>& header, const std::string& place);

/// Where a file of innovations has what.
struct InnovationFields {
  std::optional<EstimateFields> whole;  ///< innovation and covariance; else the next two
  std::size_t nis = 0, nis_dof = 0;
};

/// Understands the header of innovations: `time_s`, then `nis` and `nis_dof` alone, or as the
/// header of estimates, whose components are those of the innovation. Throws StudyError beginning
/// with `place`.
InnovationFields innovation_fields(const std::vector<std::string>& header,
                                   const std::string& place);

/// The fields of the state in the header of a truth, which may have other columns besides. Throws
/// StudyError beginning with `place`.
std::vector<std::size_t> truth_fields(const std::vector<std::string>& header,
                                      const StateShape& shape, const std::string& place);

/// Estimates or truths of one run, as a file has them.
struct StateRows {
  StateShape shape;
  std::vector<double> time;                 ///< [s] {row}, increasing
  std::vector<Eigen::VectorXd> state;       ///< {row}{width}, quaternions of length 1
  std::vector<Eigen::MatrixXd> covariance;  ///< {row}{d, d} as it stands there; empty of a truth
  std::vector<double> nis;                  ///< {row} empty where it is not there
  std::vector<std::uint32_t> nis_dof;       ///< {row} likewise
};

/// Reads estimates from CSV: mean and covariance at times. Throws StudyError naming file, line and
/// remedy where the file is empty, damaged, or has numbers that are not finite.
StateRows read_estimates(const std::filesystem::path& path);

/// How many lines of numbers a file has, as far as that can be said without reading them.
std::size_t rows_in(const std::filesystem::path& path);

/// Reads a truth of the same state; its other columns are not looked at. Throws as above.
StateRows read_truth(const std::filesystem::path& path, const StateShape& shape);

/// The number of components of a NIS. Throws StudyError beginning with `place` where the two are
/// not a sum of squares and a count.
std::uint32_t checked_dof(double nis, double dof, const std::string& place);

/// How the truth is found at the time of an estimate.
struct TimeMatch {
  double tolerance = 1e-6;   ///< [s] within which two times are the same
  bool interpolate = false;  ///< between two rows: lines, and the shorter turn of angles
};

/// The state of `truth` at `time`. Throws StudyError, worded for `estimate` (a file) and `truths`
/// (its truth), where there is none.
Eigen::VectorXd truth_at(const StateRows& truth, double time, const TimeMatch& match,
                         const std::filesystem::path& estimate,
                         const std::filesystem::path& truths);

/// The file of innovations of a file of estimates: beside it, with `innovation` in its name where
/// that has `estimate`, e.g. estimate_ekf.csv and innovation_ekf.csv. Nothing where it is not
/// there.
std::optional<std::filesystem::path> innovations_beside(const std::filesystem::path& estimates);

/// Reads innovations into `rows`, the estimates whose file is `estimates`: CSV with `time_s`, then
/// either `nis,nis_dof`, or the components of the innovation and cov_A_B of their covariance, as in
/// a file of estimates. Several rows of one time are parts of one scan and add up. A time of
/// `rows` that has none observed nothing. A covariance that is none has no NIS (NaN). Throws
/// StudyError naming file, line and remedy; a time is of an estimate within `tolerance` [s].
void read_innovations(const std::filesystem::path& path, const std::filesystem::path& estimates,
                      double tolerance, StateRows& rows);

}  // namespace montecarta::experiments
