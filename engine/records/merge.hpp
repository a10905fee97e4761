// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_layout.hpp"
#include "engine/records/result_writer.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::engine {

/// What a merge keeps in mind of one shard: nothing that grows with the size of its runs.
struct Shard {
  std::filesystem::path path;
  ResultSlabs slabs;
  std::uint64_t first_run = 0;               ///< number of the run at run index 0
  std::vector<std::uint64_t> complete_runs;  ///< numbers of the runs of which no cell is missing
  TextPairs provenance;
  double wall_seconds = 0.0;  ///< [s]

  std::size_t index(std::uint64_t run) const { return run - first_run; }
};

/// Throws StudyError where the file at `path` is no result.
ResultDescription describe_shard(const std::filesystem::path& path);
Shard make_shard(const std::filesystem::path& path, const ResultDescription& description);

/// Throws StudyError where the two shards hold different bytes for a run they both have.
void expect_equal(const Shard& a, const Shard& b, std::uint64_t run);
/// Throws StudyError where a run does not fit its fingerprints.
void expect_whole(const PosixFile& file, const Shard& shard, std::uint64_t run,
                  std::vector<std::byte>& buffer);
/// Runs of the study that follow each other.
struct RunSpan {
  std::uint64_t first = 0;
  std::size_t count = 0;
};

/// Copies all cells of some runs and their true paths to a file of the whole study; tells how many
/// runs of cells failed.
std::uint64_t copy_runs(const PosixFile& from, const Shard& shard, RunSpan runs,
                        const PosixFile& to, const ResultSlabs& slabs);
/// Copies one run of one cell between files that hold the same runs, its status last.
void copy_cell(const PosixFile& from, const CellSlabs& source, const PosixFile& to,
               const CellSlabs& sink, std::size_t run_index);
/// The same for its true path; nothing where there is none to store.
void copy_truth(const PosixFile& from, const ResultSlabs& source, const PosixFile& to,
                const ResultSlabs& sink, std::size_t run_index);

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
