// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_rows.hpp"

#include <filesystem>
#include <optional>

namespace montecarta::experiments {

/// Trajectories of poses in space as lines of numbers between blanks, without a header; `#` begins
/// a comment. The layout of the TUM RGB-D benchmark, which evo reads too:
///   timestamp tx ty tz qx qy qz qw
/// has its covariances beside it (covariance_beside()). That of OpenVINS (ov_eval) has them in the
/// same line, rotation before position, and none between the two:
///   timestamp tx ty tz qx qy qz qw Pr11 Pr12 Pr13 Pr22 Pr23 Pr33 Pt11 Pt12 Pt13 Pt22 Pt23 Pt33
/// There Pt is of the position in the map, Pr of the rotation in the frame of the estimated body,
/// Log(R_truth' R_mean), as ov_eval judges them. Read, Pr is turned into the map, R Pr R', which
/// makes both of the error `world` (19.1).

/// Whether a file is in one of these layouts: its first line is no row of a CSV file.
bool is_tum(const std::filesystem::path& path);

/// STEM.cov, beside STEM.ANYTHING: lines of a timestamp and 36 numbers row by row, or 21 of the
/// upper triangle, in the order x, y, z, rx, ry, rz; the same times as the poses. Nothing where it
/// is not there.
std::optional<std::filesystem::path> covariance_beside(const std::filesystem::path& path);

/// As read_estimates().
StateRows read_tum_estimates(const std::filesystem::path& path);
/// As read_truth(); what stands behind the pose is not looked at.
StateRows read_tum_truth(const std::filesystem::path& path, const StateShape& shape);

}  // namespace montecarta::experiments
