// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_rows.hpp"

#include <filesystem>
#include <string>

namespace montecarta::experiments {

/// Throws StudyError with file, line and factor if the times of a file are not in seconds, because
/// they lie thousands of years after 1970 or the rows are weeks apart.
void require_seconds(const StateRows& rows, const std::filesystem::path& path);

/// A sentence on times that may be in microseconds, but are not refused by require_seconds(); empty
/// if they look like seconds.
std::string note_on_times(const StateRows& rows, const std::filesystem::path& path);

/// Throws StudyError with the factor if the times of estimates and their truth differ by the factor
/// between s and ms, us or ns. `estimates` and `truths` name the files.
void require_same_time_unit(const StateRows& rows, const std::filesystem::path& estimates,
                            const StateRows& truth, const std::filesystem::path& truths);

}  // namespace montecarta::experiments
