// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/cell_spec.hpp"
#include "experiments/study/settings.hpp"

#include <span>

namespace montecarta::experiments {

/// Throws StudyError where a cell's filter does not take the sensor of [belief], where that is
/// mounted elsewhere than the filter can, or where it would have to find out which landmark a
/// detection is of that does not fix one.
void refuse_sensors(const Settings& settings, std::span<const CellSpec> cells);

}  // namespace montecarta::experiments
