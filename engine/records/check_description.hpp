// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"

#include <filesystem>

namespace montecarta::engine {

/// Throws StudyError unless the parts of a description are consistent: every index, count and time
/// is valid, and all columns of a cell have the same axes.
void check_description(const ResultDescription& description, const std::filesystem::path& path);

}  // namespace montecarta::engine
