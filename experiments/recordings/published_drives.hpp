// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"

#include <filesystem>

namespace montecarta::experiments {

/// Which record of the steering angle a Victoria Park drive follows.
enum class Steering {
  calibrated,  ///< DRS.txt, of the text release
  raw          ///< aa3_dr.mat, of the .mat release: the one that the papers use
};

/// The drive through Victoria Park (Sydney; E. Nebot and J. Guivant, ACFR) from the files as
/// published, trees detected: 4 km, 1545 s. x points East, y North [m] from the first GPS fix;
/// times are those of the text release [s].
///
/// Odometry is that of `steering`. Sweeps come from LASER.txt, or aa3_lsr2.mat where that is
/// absent; references are "gps" (GPS.txt) and "gps_all" (aa3_gpsx.mat), of which one is needed.
/// Sensors_manager.txt, where it is there, is held against the text files that were read. Throws
/// StudyError naming file and record where one is missing or damaged.
DriveLog read_victoria_park(const std::filesystem::path& folder, Steering steering);

/// The drive around a car park with reflecting poles (E. Nebot and J. Guivant, ACFR) from
/// data_set.mat as published, poles detected: 125 s. x points East, y North [m]; times as published
/// [s]. Reference "gps"; landmarks are the surveyed poles of beac_juan3.mat where it is there.
/// Throws StudyError naming file and record where one is missing or damaged.
DriveLog read_car_park(const std::filesystem::path& folder);

}  // namespace montecarta::experiments
