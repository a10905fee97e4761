// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace montecarta {

/// Names and widths on which the writer of a result file and its reader agree (analysis/FORMAT.md).
namespace format {
inline constexpr std::string_view kFiletype = "montecarta-results";
inline constexpr std::uint64_t kMajor = 1;         ///< grows when a meaning changes
inline constexpr std::uint64_t kMinor = 0;         ///< grows when something is added
inline constexpr std::size_t kSittings = 16;       ///< how many starts and resumptions are logged
inline constexpr std::size_t kSittingBytes = 256;  ///< width of a line of that log
}  // namespace format

/// Creates at `path` a complete, closed result file in which every run is missing: all groups,
/// attributes and scales, and for every dataset its final place. Throws RunError where the disk
/// fails.
void lay_out(const std::filesystem::path& path, const ResultDescription& description);

}  // namespace montecarta
