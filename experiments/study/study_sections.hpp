// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/printed.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/ini_text.hpp"
#include "experiments/worlds/world.hpp"

#include <span>
#include <string>

namespace montecarta::experiments {

/// A world written out in a study: [world] with `waypoint = x, y` and `landmark = x, y` lines [m].
bool has_inline_world(const IniText& ini);
World read_inline_world(const IniText& ini, const std::string& name, const std::string& place);
/// The lines below [world] that read back as exactly this world.
std::string inline_world_text(const World& world);

/// What a study says that a paper printed: its lines below [printed]. Throws StudyError with line
/// and remedy where one is not understood, or names a cell or a metric that there is not.
Printed read_printed(std::span<const IniEntry> entries, std::span<const CellSpec> cells);

}  // namespace montecarta::experiments
