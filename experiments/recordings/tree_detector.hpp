// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "experiments/recordings/laser.hpp"

#include <vector>

namespace montecarta::experiments {

/// The trunks of trees in one sweep of ranges [m]: centre of the trunk, by increasing bearing, none
/// identified. The detector of every code on the Victoria Park data (J. Guivant, ACFR), step by
/// step as in [trees] of experiments/RECORDED_DRIVES.md.
std::vector<Detection> detect_trees(LaserSweep ranges);

}  // namespace montecarta::experiments
