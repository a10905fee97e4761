// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"
#include "experiments/study/settings.hpp"

#include <filesystem>
#include <memory>
#include <vector>

namespace montecarta::experiments {

/// The recorded drives that the settings of a study name, one or, of kind log, one for each run;
/// `folder` is where relative paths may begin. Fills in scenario.data_sha256, and scenario.path by
/// the kind of the drive: what a study is called does not depend on where its data lie. Throws
/// StudyError where a drive cannot be read or is not the one that the study was made with, or where
/// there are not as many as runs.
std::vector<std::shared_ptr<const DriveLog>> read_drives_of(Settings& settings,
                                                            const std::filesystem::path& folder);

}  // namespace montecarta::experiments
