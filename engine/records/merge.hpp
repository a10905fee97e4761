// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"
#include "engine/records/shard.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace montecarta::engine {

/// Merges shards to one self-contained file of all runs of a study. Every run is checked by its
/// fingerprints and copied unchanged. Memory does not grow with the number of runs. `out` gets its
/// name only when it is complete. Throws StudyError if a shard is of another study or damaged,
/// if runs in two shards differ, or if runs are missing; RunError if the disk fails. `out` does not
/// exist then.
MergeSummary merge_results(const std::filesystem::path& out,
                           const std::vector<std::filesystem::path>& shards, Existing existing);

/// The same for several processes that may merge into `out` at once, or be killed: each writes a
/// file of its own, of which the first complete one gets the name `out`. nullopt if this process
/// could not merge because another one had.
std::optional<MergeSummary> merge_attempt(const std::filesystem::path& out,
                                          const std::vector<std::filesystem::path>& shards);

}  // namespace montecarta::engine
