// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/result_description.hpp"

#include <filesystem>

/// The writer and the reader of everything in a result file but the numbers of its runs. The fields
/// are listed once for both (analysis/FORMAT.md).
namespace montecarta::engine {

/// Creates a closed result file at `path` in which every run is missing. It has all groups,
/// attributes and scales, and the final place of every dataset. Throws RunError if the disk fails.
void lay_out(const std::filesystem::path& path, const ResultDescription& description);

/// Reads the description. Throws StudyError if a required part cannot be read.
void read_schema(const h5::Handle& file, ResultDescription& description);

}  // namespace montecarta::engine
