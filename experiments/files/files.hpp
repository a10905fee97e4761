// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// A file that comes with montecarta, e.g. ("worlds", "web_loop.csv"): beside the installed
/// executable (../share/montecarta), else in the source tree this was built from. nullopt where
/// there is none.
std::optional<std::filesystem::path> shipped_file(const std::string& folder,
                                                  const std::string& name);

/// Names without ending of the files of a shipped folder that end so, in alphabetical order.
std::vector<std::string> shipped_names(const std::string& folder, const std::string& ending);

/// A file of more bytes than this is no study, world or log, and would not fit into memory either.
inline constexpr std::uintmax_t kLargestFile = std::uintmax_t{512} << 20U;

/// All bytes of a file that the user named. Throws StudyError where there is none, where it is no
/// file (a folder, a device), cannot be read or is larger than kLargestFile.
std::string whole_file(const std::filesystem::path& path);
/// The text of a file in UTF-8, without a byte order mark. Throws StudyError as whole_file() does,
/// and if the file is in UTF-16 or holds NUL bytes.
std::string text_file(const std::filesystem::path& path);

}  // namespace montecarta::experiments
