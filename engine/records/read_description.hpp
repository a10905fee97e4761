// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/result_description.hpp"

#include <filesystem>

namespace montecarta::engine {

/// What an open result file says of itself. Throws StudyError where it is no montecarta result of a
/// known major version, RunError where something that must be there cannot be read, or contradicts
/// what else is there (check_description()).
ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path);

}  // namespace montecarta::engine
