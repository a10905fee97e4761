// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"

#include <filesystem>

namespace montecarta::engine {

/// Throws RunError unless all that a file says of itself goes together: every number in it that is
/// an index, a count or a time of others is one, and all columns of a cell have the same axes.
void check_description(const ResultDescription& description, const std::filesystem::path& path);

}  // namespace montecarta::engine
