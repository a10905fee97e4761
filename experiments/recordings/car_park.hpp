// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"

#include <filesystem>

namespace montecarta::experiments {

/// The drive around a car park with reflecting poles (E. Nebot and J. Guivant, ACFR) from
/// data_set.mat as published, poles detected: 125 s. x points East, y North [m]; times as published
/// [s]. Reference "gps"; landmarks are the surveyed poles of beac_juan3.mat where it is there.
/// Throws StudyError naming file and record where one is missing or damaged.
DriveLog read_car_park(const std::filesystem::path& folder);

}  // namespace montecarta::experiments
