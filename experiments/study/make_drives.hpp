// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/study.hpp"
#include "filters/models/control_noise.hpp"
#include "filters/models/vehicle.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace montecarta::experiments {

/// The vehicle of a section: [scenario] or [belief].
Vehicle vehicle_of(const Settings& settings, const char* section);
/// The noise of the controls of that vehicle, as the section says it.
ControlNoise control_noise_of(const Settings& settings, const char* section);
/// How many landmarks detections can name; 0 where nobody identified them.
std::size_t identities_of(const Study& study);
/// The drives of a study. Throws StudyError where its settings do not fit together.
std::shared_ptr<const DriveSource> drives_of(const Study& study, std::uint64_t seed);

/// Draws the landmarks of a run; empty where all runs have those of the world.
std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks_of(const Study& study,
                                                                                std::uint64_t seed);

}  // namespace montecarta::experiments
