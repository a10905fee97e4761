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

/// The recorded drives that the settings of a study name, one or, of kind log, one for each run;
/// `folder` is where relative paths may begin. Fills in scenario.data_sha256, and scenario.path by
/// the kind of the drive: what a study is called does not depend on where its data lie. Throws
/// StudyError where a drive cannot be read or is not the one that the study was made with, or where
/// there are not as many as runs.
std::vector<std::shared_ptr<const DriveLog>> read_drives_of(Settings& settings,
                                                            const std::filesystem::path& folder);

/// The vehicle of a section: [scenario] or [belief].
Vehicle vehicle_of(const Settings& settings, const char* section);
Sensor sensor_of(const Settings& settings, const char* section);
/// The noise of the controls of that vehicle, as the section says it.
ControlNoise control_noise_of(const Settings& settings, const char* section);
/// The sensor of a section, as it is mounted, and the deviations of its components, each times
/// `factor`, for a belief or a scenario.
template <class Owner>
void take_sensor(const Settings& settings, const char* section, double factor, Owner& owner) {
  owner.sensor = sensor_of(settings, section);
  for (const Quantity quantity : components_of(owner.sensor)) {
    const std::string& key = component_of(quantity).sigma.key;
    deviation_of(quantity, owner) = factor * in_si(key, settings.number(section, key));
  }
}
/// How many landmarks detections can name; 0 where nobody identified them.
std::size_t identities_of(const Study& study);
/// The drives of a study. Throws StudyError where its settings do not fit together.
std::shared_ptr<const DriveSource> drives_of(const Study& study, std::uint64_t seed);

/// Draws the landmarks of a run; empty where all runs have those of the world.
std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks_of(const Study& study,
                                                                                std::uint64_t seed);

}  // namespace montecarta::experiments
