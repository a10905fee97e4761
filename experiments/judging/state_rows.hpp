// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_columns.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

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
