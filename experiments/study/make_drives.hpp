// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"
#include "experiments/study/settings.hpp"
#include "experiments/study/study.hpp"
#include "filters/models/vehicle.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

namespace montecarta::experiments {

/// Reads the recorded drives that the settings of a study name: one, or one for each run. Relative
/// paths may begin in `folder`. Fills in scenario.data_sha256 and replaces scenario.path by the
/// kind of the drive, so that the text of the study does not depend on where the data are stored.
/// Throws StudyError if a drive cannot be read or is not the one of an earlier run of the study, or
/// if the number of drives is not that of the runs.
std::vector<std::shared_ptr<const DriveLog>> read_drives_of(Settings& settings,
                                                            const std::filesystem::path& folder);

/// The vehicle of a section: [scenario] or [belief].
Vehicle vehicle_of(const Settings& settings, const char* section);
Sensor sensor_of(const Settings& settings, const char* section);
/// The noise of the controls of that vehicle, as set in the section.
ControlNoise control_noise_of(const Settings& settings, const char* section);
/// Sets the sensor of a belief or a scenario, its mounting and the deviations of its components
/// from a section. The deviations are multiplied by `factor`.
template <class Owner>
void take_sensor(const Settings& settings, const char* section, double factor, Owner& owner) {
  owner.sensor = sensor_of(settings, section);
  for (const Quantity quantity : components_of(owner.sensor)) {
    const std::string& key = component_of(quantity).sigma.key;
    deviation_of(quantity, owner) = factor * in_si(key, settings.number(section, key));
  }
}
/// Number of landmarks that detections can name; 0 if they have no identities.
std::size_t identities_of(const Study& study);
/// Makes the drives of a study. Throws StudyError if its settings do not fit together.
std::shared_ptr<const DriveSource> drives_of(const Study& study, std::uint64_t seed);

/// A function that draws the landmarks of a run; empty if all runs have those of the world.
std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks_of(const Study& study,
                                                                                std::uint64_t seed);

}  // namespace montecarta::experiments
