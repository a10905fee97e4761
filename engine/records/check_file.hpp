// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"
#include "engine/records/seal.hpp"

#include <filesystem>

namespace montecarta::engine {

/// Checks a result file before this process opens it with the HDF5 library: its seal, or, if it has
/// none, its structure and all of its runs. Another process reads a file without a seal, because
/// damage to it may crash the library. Throws StudyError if anything differs.
Seal check_file(const std::filesystem::path& path);

/// The description of a file that check_file() has accepted.
ResultDescription read_description(const std::filesystem::path& path);

}  // namespace montecarta::engine
