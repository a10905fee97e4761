// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The folder that a study means by `path`: below one of `folders`, or as it is, or below a folder
/// of the environment variable MONTECARTA_DATA (separated by colons). Throws StudyError where there
/// is none.
std::filesystem::path find_recording(const std::string& path,
                                     const std::vector<std::filesystem::path>& folders);

/// The folders that a list names, separated by commas; where a folder has commas in its name, and
/// is there, it is one.
std::vector<std::string> recordings_in(const std::string& list,
                                       const std::vector<std::filesystem::path>& folders);

/// SHA-256 of all that a log says, hexadecimal: whatever files it came in, the same drive has the
/// same one.
std::string fingerprint_of(const DriveLog& log);

}  // namespace montecarta::experiments
