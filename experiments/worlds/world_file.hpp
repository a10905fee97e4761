// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/worlds/world.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Reads a world from .csv (header `kind,x,y`, kind landmark or waypoint, # begins a comment) or
/// from a MATLAB .mat with `lm` and `wp`. Throws StudyError naming file and line where it is
/// missing or malformed.
World read_world_file(const std::filesystem::path& path);
World read_world_csv(const std::filesystem::path& path);
World read_world_mat(const std::filesystem::path& path);

/// Reads the world that a study calls `name`: a path ending in .csv or .mat, tried below each of
/// `folders` and then as it stands, or else a shipped world.
World find_world(const std::string& name, const std::vector<std::filesystem::path>& folders = {});

/// Names of the worlds that come with montecarta, in alphabetical order.
std::vector<std::string> shipped_worlds();

}  // namespace montecarta::experiments
