// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/ini_text.hpp"
#include "experiments/worlds/world.hpp"

#include <string>

namespace montecarta::experiments {

/// A world written out in a study: [world] with `waypoint = x, y` and `landmark = x, y` lines [m].
bool has_inline_world(const IniText& ini);
World read_inline_world(const IniText& ini, const std::string& name, const std::string& place);
/// The lines below [world] that read back as exactly this world.
std::string inline_world_text(const World& world);

}  // namespace montecarta::experiments
