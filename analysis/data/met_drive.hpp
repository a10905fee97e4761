// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"

#include <cstddef>
#include <span>

namespace montecarta::analysis {

/// What a run met that may be its own: views into a file's description.
struct MetDrive {
  std::span<const double> scan_times;         ///< [s]
  std::span<const std::uint32_t> scan_steps;  ///< step after which each scan was taken
  Pose start;                                 ///< before the first step
  std::span<const ReferencePath> references;  ///< of a recorded drive
};

/// Of run number `run` of the study, held by the file or not. The file must outlive it.
inline MetDrive drive_met_by(const ResultFile& file, std::uint64_t run) {
  const ResultDescription& all = file.description();
  if (all.drives.empty()) return {all.scan_times, all.scan_steps, all.start, all.references};
  const OwnDrive& own = all.drives.at(run);
  return {own.scan_times, own.scan_steps, own.start, own.references};
}

}  // namespace montecarta::analysis
