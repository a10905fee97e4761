// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "experiments/recordings/drive_log.hpp"

namespace montecarta::experiments {

/// Whether a log tells which landmark each detection is of.
enum class Identities { told, withheld };

/// A drive with known truth as if it had been recorded: RecordedDrive makes the same steps,
/// controls and scans of it, bit for bit, while no detection is beyond its max_range. Times count
/// from the start. The truth after every step is its only reference, `landmarks` its survey,
/// `controls` what its controls are.
DriveLog log_of(const Itinerary& itinerary, const Drive& drive,
                std::span<const ControlName> controls, std::vector<Eigen::Vector2d> landmarks,
                Identities identities);

}  // namespace montecarta::experiments
