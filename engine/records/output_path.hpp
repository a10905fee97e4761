// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <filesystem>

namespace montecarta::engine {

/// Name of the work in progress of the result `path`.
std::filesystem::path part_of(std::filesystem::path path);

/// Whether something has that name. False where its folder may not be searched: opening the file
/// says so better than this could.
bool is_there(const std::filesystem::path& path);

/// Throws StudyError where something has that name already.
void expect_free(const std::filesystem::path& path);

}  // namespace montecarta::engine
