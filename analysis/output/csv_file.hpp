// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/frame.hpp"

#include <filesystem>
#include <string>

namespace montecarta::analysis {

/// Writes columns below their names as comma-separated values (RFC 4180: fields with commas or
/// quotes are quoted). Throws RunError naming the file where it cannot be written.
void write_csv(const Frame& frame, const std::filesystem::path& path);

/// Makes a directory and those above it. Throws RunError if that fails.
void make_directory(const std::filesystem::path& directory);

/// Writes a whole file, binary or text. If it fails, the old file is unchanged, and it throws
/// RunError with the name of the file.
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace montecarta::analysis
