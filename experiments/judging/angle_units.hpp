// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_rows.hpp"

#include <filesystem>
#include <string>

namespace montecarta::experiments {

/// Throws StudyError with file, line and remedy if a heading, or another angle of an orientation,
/// is in degrees although its column says rad: it has values beyond two turns, and steps that
/// radians cannot have. A heading that counts turns is in rad: its steps stay below half a turn.
void require_radians(const StateRows& rows, const std::filesystem::path& path);

/// A sentence on angles that may be in degrees, but are not refused by require_radians(); empty if
/// there are none.
std::string note_on_angles(const StateRows& rows, const std::filesystem::path& path);

}  // namespace montecarta::experiments
