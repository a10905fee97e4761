// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace montecarta::experiments {

/// A file of more bytes than this is no study, world or log, and would not fit into memory either.
inline constexpr std::uintmax_t kLargestFile = std::uintmax_t{512} << 20U;

/// All bytes of a file that the user named. Throws StudyError where there is none, where it is no
/// file (a folder, a device), cannot be read or is larger than kLargestFile.
std::string whole_file(const std::filesystem::path& path);

}  // namespace montecarta::experiments
