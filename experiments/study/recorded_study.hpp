// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"
#include "experiments/study/settings.hpp"

#include <filesystem>
#include <memory>

namespace montecarta::experiments {

/// The recorded drive that the settings of a study name; `folder` is where relative paths may
/// begin. Fills in scenario.data_sha256, and scenario.path by the kind of the drive: what a study
/// is called does not depend on where its data lie. Throws StudyError where the drive cannot be
/// read or is not the one that the study was made with.
std::shared_ptr<const DriveLog> read_drive_of(Settings& settings,
                                              const std::filesystem::path& folder);

}  // namespace montecarta::experiments
