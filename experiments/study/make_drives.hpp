// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "experiments/study/study.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace montecarta::experiments {

/// Makes the drives of a study. Throws StudyError if its settings do not fit together.
std::shared_ptr<const DriveSource> drives_of(const Study& study, std::uint64_t seed);

/// A function that draws the landmarks of a run; empty if all runs have those of the world.
std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks_of(const Study& study,
                                                                                std::uint64_t seed);

}  // namespace montecarta::experiments
