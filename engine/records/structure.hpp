// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"

#include <cstdint>
#include <filesystem>

/// The structure of a result file, stored in the file itself: all groups and datasets with types,
/// axes, attributes, and the contents that are no runs. HDF5 libraries cut off the seal of a file
/// that they change; this remains (analysis/FORMAT.md, "The structure").
namespace montecarta::engine {

/// Stores the structure in a file in which all other objects are present.
void put_structure(const h5::Handle& file);

/// Throws StudyError that names the first difference between a file and its stored structure. Files
/// of versions before 1.11 have none and are not checked.
void check_structure(const h5::Handle& file, std::uint64_t minor_version,
                     const std::filesystem::path& path);

}  // namespace montecarta::engine
