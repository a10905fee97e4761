// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace montecarta::engine {

/// Names and widths on which the writer of a result file and its reader agree (analysis/FORMAT.md).
namespace format {
inline constexpr std::string_view kFiletype = "montecarta-results";
inline constexpr std::uint64_t kMajor = 1;           ///< grows when a meaning changes
inline constexpr std::uint64_t kMinor = 8;           ///< grows when something is added
inline constexpr std::size_t kSittingsBytes = 4096;  ///< room for the log of resumptions
/// Fact of /provenance: --force allowed finishing to replace what had the final name.
inline constexpr std::string_view kReplaces = "replaces";
/// Group of /scenario, with one group for each independent measurement of the path.
inline constexpr const char* kReferences = "references";
/// Group of /scenario, with one group for each run where every run is a recorded drive of its own.
inline constexpr const char* kDrives = "drives";
}  // namespace format

/// Creates at `path` a complete, closed result file in which every run is missing: all groups,
/// attributes and scales, and for every dataset its final place. Throws RunError where the disk
/// fails.
void lay_out(const std::filesystem::path& path, const ResultDescription& description);

}  // namespace montecarta::engine
