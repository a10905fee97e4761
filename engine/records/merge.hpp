// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_writer.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::engine {

/// What a merge did.
struct MergeSummary {
  std::uint64_t runs = 0;
  std::size_t cells = 0;
  std::uint64_t failed = 0;        ///< runs of cells that are stored as failed
  std::uint64_t overlapping = 0;   ///< runs found equal in more than one shard
  std::uint64_t bytes = 0;         ///< size of the new file
  std::vector<std::string> notes;  ///< what a user should hear, e.g. of different builds
};

/// Makes one self-contained file of all runs of a study out of shards, each checked by its
/// fingerprints and copied as it is; memory does not grow with the runs. `out` appears under its
/// name only when complete. Throws StudyError and writes nothing where a shard is of another study,
/// runs held twice differ, or runs are missing; RunError where a shard is damaged or the disk
/// fails.
MergeSummary merge_results(const std::filesystem::path& out,
                           const std::vector<std::filesystem::path>& shards, Existing existing);

}  // namespace montecarta::engine
