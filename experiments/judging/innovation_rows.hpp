// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/gate.hpp"
#include "experiments/judging/passed_innovations.hpp"
#include "experiments/judging/state_rows.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace montecarta::experiments {

/// The file of innovations beside a file of estimates. Its name has `innovation` instead of
/// `estimate`, e.g. innovation_ekf.csv for estimate_ekf.csv. nullopt if it does not exist.
std::optional<std::filesystem::path> innovations_beside(const std::filesystem::path& estimates);

/// Which innovations of a file are read, and what they mean.
struct InnovationChoice {
  std::string sensor = {};  ///< only those of this sensor; empty: all
  /// Gate of the filter. The NIS of a row that it let pass is put on the scale of all innovations
  /// (STATISTICS (9.3)).
  std::optional<Gate> gate = {};
  /// Whether to fill state and covariance of `rows` too, if the file has components: with the sum
  /// of the innovations of one time, divided by the root of their number, and its covariance.
  bool with_components = false;
};

/// Reads innovations into `rows`, which holds the estimates of the file `estimates`. The file is
/// CSV with `time_s`, then either `nis,nis_dof`, or the components of the innovation and cov_A_B of
/// their covariance, as in a file of estimates. Rows with the same time are parts of one scan and
/// are added up. Estimates without a row have observed nothing. The NIS is NaN if the covariance is
/// not positive definite. Angles beyond pi are used as they are, and counted. Throws StudyError
/// with file, line and remedy, also if no estimate has the time of a row within `tolerance` [s], or
/// a NIS is beyond the gate.
void read_innovations(const std::filesystem::path& path, const std::filesystem::path& estimates,
                      double tolerance, StateRows& rows, const InnovationChoice& choice = {});

/// The innovations of each sensor in a file; of "" if it has no such column.
std::map<std::string, PassedInnovations> innovations_in(const std::filesystem::path& path);

}  // namespace montecarta::experiments
