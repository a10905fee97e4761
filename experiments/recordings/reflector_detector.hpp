// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "experiments/recordings/laser.hpp"

#include <vector>

namespace montecarta::experiments {

/// The reflecting poles in one sweep of ranges [m] and intensities: centre of the pole, by
/// increasing bearing, none identified. See [reflectors] of experiments/RECORDED_DRIVES.md.
std::vector<Detection> detect_reflectors(LaserSweep ranges, LaserSweep intensities);

}  // namespace montecarta::experiments
