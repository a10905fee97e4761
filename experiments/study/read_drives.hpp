// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"
#include "experiments/study/settings.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

namespace montecarta::experiments {

/// Recorded drives, and the absolute paths of the folders that they were read from.
struct RecordedDrives {
  std::vector<std::shared_ptr<const DriveLog>> logs;
  std::vector<std::filesystem::path> folders;  ///< {log}
};

/// Reads the recorded drives that the settings of a study name: one, or one for each run. Relative
/// paths may begin in `folder`. Fills in scenario.data_sha256 and replaces scenario.path by the
/// kind of the drive, so that the text of the study does not depend on where the data are stored.
/// Throws StudyError if a drive cannot be read or is not the one of an earlier run of the study, or
/// if the number of drives is not that of the runs.
RecordedDrives read_drives_of(Settings& settings, const std::filesystem::path& folder);

/// Number of landmarks that the detections can name; 0 if they have no identities.
std::size_t identities_in(const DriveLog& log);

}  // namespace montecarta::experiments
