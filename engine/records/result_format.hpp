// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// Names and widths that are shared by writer and reader of a result file (analysis/FORMAT.md).
namespace montecarta::engine::format {

inline constexpr std::string_view kFiletype = "montecarta-results";
inline constexpr std::uint64_t kMajor = 1;           ///< increased when a meaning changes
inline constexpr std::uint64_t kMinor = 11;          ///< increased when something is added
inline constexpr std::size_t kSessionsBytes = 4096;  ///< size of the log of resumptions
inline constexpr const char* kSums = "sums";         ///< group of the sums over groups of runs
/// Dataset in the timing of a cell with the processor time of every run in sums.
inline constexpr const char* kSumSeconds = "sums_cpu_seconds";
inline constexpr const char* kFull = "full";  ///< group of a cell for the columns of full runs only
inline constexpr const char* kFullRun = "full_run";  ///< first axis of those columns
/// Attribute: number of full runs in the study.
inline constexpr const char* kFullRuns = "full_runs";
/// Members of the group of a cell that are no columns.
inline constexpr std::array<std::string_view, 6> kBesideColumns = {
    "status", "failure_reason", "failure_step", "fingerprint", kFull, "settings"};
/// Fact in /provenance: --force was given, so finishing may replace the file with the final name.
inline constexpr std::string_view kReplaces = "replaces";

}  // namespace montecarta::engine::format
