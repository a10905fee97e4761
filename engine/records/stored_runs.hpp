// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/result_description.hpp"

#include <filesystem>

namespace montecarta::engine {

/// Compares all runs of a file without a seal with their fingerprints. HDF5 reads the numbers,
/// because another program may have packed them. Throws StudyError that names the first run that
/// differs.
void check_stored_runs(const h5::Handle& file, const ResultDescription& description,
                       const std::filesystem::path& path);

}  // namespace montecarta::engine
