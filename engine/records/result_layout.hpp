// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/labelled_dataset.hpp"
#include "engine/records/result_description.hpp"

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

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

/// Group `references` in `scenario`, or in one of its drives; nothing where there are none.
void add_references(const h5::Handle& scenario, const std::vector<ReferencePath>& references,
                    Scales& scales);
/// Group `drives` in `scenario`, with a group for each; nothing where there are none.
void add_own_drives(const h5::Handle& scenario, const std::vector<OwnDrive>& drives,
                    Scales& scales);

std::vector<ReferencePath> read_references(const h5::Handle& scenario);
std::vector<OwnDrive> read_own_drives(const h5::Handle& scenario);

/// Throws StudyError unless all that a file says of itself goes together: every number in it that
/// is an index, a count or a time of others is one, and all columns of a cell have the same axes.
void check_description(const ResultDescription& description, const std::filesystem::path& path);

/// What an open result file says of itself. Throws StudyError where it is no montecarta result of a
/// known major version, RunError where something that must be there cannot be read, or contradicts
/// what else is there (check_description()).
ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path);

}  // namespace montecarta::engine
