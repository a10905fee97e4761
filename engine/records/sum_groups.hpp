// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/shard.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// Results that hold sums over groups of runs instead of the rows of each run (if record.columns
/// has sums). The runs of a group are analysed as soon as they are made. The engine stores the sums
/// as words, whose meaning is defined by the analysis (analysis/FORMAT.md, "/sums").
namespace montecarta::engine {

/// The head of the sums of one cell over one group of runs, as stored in a file.
struct SumGroup {
  std::uint64_t first_run = 0;  ///< number of its first run in the study
  std::uint64_t runs = 0;
  std::uint64_t complete = 0, failed = 0;  ///< numbers of complete and failed runs
  std::uint64_t layout = 0;                ///< fingerprint of the meaning of the words
  std::uint64_t words = 0;                 ///< number of the words of the sums
  std::uint64_t offset = 0;                ///< [byte] offset of the head in the file
};

/// Words before the sums of a group: the members of SumGroup up to `words`.
inline constexpr std::size_t kGroupHeadWords = 6;

/// The groups of a cell, in the order of the runs. Throws StudyError unless they are those of the
/// description.
std::vector<SumGroup> find_groups(const PosixFile& file, const Slab& sums, const SummedRuns& runs);
/// The sums of a group, without its head.
std::vector<std::uint64_t> read_sums(const PosixFile& file, const SumGroup& group);

/// Sums over one group, to be written; `offset` is not used.
struct NewGroup {
  SumGroup head;
  std::vector<std::uint64_t> sums;
  std::vector<double> cpu_seconds;  ///< {run} [s] processor time, which is no function of the study
};

/// Writes the result of one group: the sums of each cell, and the first runs of the file `rows`,
/// which has all runs of the group. Several processes may write it at once.
void write_group(const std::filesystem::path& out, const std::filesystem::path& rows,
                 std::span<const NewGroup> cells);

/// Makes one result of others that hold sums over all groups of [first_run, last_run). Throws
/// StudyError if a group is missing, or differs between two of them.
MergeSummary merge_groups(const std::filesystem::path& out,
                          const std::vector<std::filesystem::path>& shards, std::uint64_t first_run,
                          std::uint64_t last_run, Existing existing);

}  // namespace montecarta::engine
