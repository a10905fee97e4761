// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"

#include <filesystem>
#include <string>

namespace montecarta::experiments {

/// Reads a reference of a log (experiments/RECORDED_DRIVES.md): fixes of a position or a pose, with
/// or without standard deviations or the covariance of their errors. Throws StudyError naming file
/// and line where a row is malformed, a standard deviation is not above 0, or a covariance is not
/// positive definite.
ReferencePath read_reference_csv(const std::filesystem::path& path, const std::string& name);

/// The text of that file; reading it gives the same numbers bit for bit.
std::string csv_of(const ReferencePath& reference);

}  // namespace montecarta::experiments
