// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_rows.hpp"

#include <filesystem>
#include <optional>

namespace montecarta::experiments {

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
