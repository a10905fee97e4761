// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/result_description.hpp"

#include <cstdint>
#include <filesystem>

namespace montecarta::engine {

/// The minor version of the format. Throws StudyError if the file is no montecarta result of a
/// known major version.
std::uint64_t minor_version_of(const h5::Handle& file, const std::filesystem::path& path);

/// Reads the description of an open result file. Throws StudyError if it is no montecarta result of
/// a known major version, or if a required part cannot be read or is inconsistent
/// (check_description()).
ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path);

}  // namespace montecarta::engine
