// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/seal.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::engine {

/// The part of a shard that a merge keeps in memory. It does not grow with the size of the runs.
struct Shard {
  std::filesystem::path path;
  ResultSlabs slabs;
  std::uint64_t first_run = 0;               ///< number of the run at run index 0
  std::vector<std::uint64_t> complete_runs;  ///< numbers of the runs that are missing in no cell
  TextPairs provenance;
  double wall_seconds = 0.0;  ///< [s] wall time of all sessions

  std::size_t index(std::uint64_t run) const { return run - first_run; }
};

Shard make_shard(const std::filesystem::path& path, const ResultDescription& description);

/// Throws StudyError if the two shards hold different bytes for run `run`, which both have.
void require_equal(const Shard& a, const Shard& b, std::uint64_t run);
/// Throws StudyError if a run does not match its fingerprints.
void require_whole(const PosixFile& file, const Shard& shard, std::uint64_t run,
                   std::vector<std::byte>& buffer);
/// The ranges of a file that are written after it is laid out, increasing and disjoint.
std::vector<ByteRange> written_later(const ResultSlabs& slabs);

/// Consecutive runs of the study.
struct RunSpan {
  std::uint64_t first = 0;
  std::size_t count = 0;
};

/// Copies all cells and the true paths of some runs to those from run index `index` on of another
/// file.
void copy_runs(const PosixFile& from, const Shard& shard, RunSpan runs, const PosixFile& to,
               const ResultSlabs& slabs, std::size_t index);
/// Copies one run of one cell between files with the same runs. The status is copied last.
void copy_cell(const PosixFile& from, const CellSlabs& source, const PosixFile& to,
               const CellSlabs& sink, std::size_t run_index);
/// Copies the true path of one run, if it is stored.
void copy_truth(const PosixFile& from, const ResultSlabs& source, const PosixFile& to,
                const ResultSlabs& sink, std::size_t run_index);

/// Throws StudyError with the missing runs, as ranges such as "3:5", and the commands that compute
/// the first of them. `missing` is their number, of `runs` runs.
[[noreturn]] void refuse_gaps(const std::vector<std::string>& gaps, std::uint64_t missing,
                              std::uint64_t runs, const std::filesystem::path& shard);

/// Summary of a merge.
struct MergeSummary {
  std::uint64_t runs = 0;
  std::size_t cells = 0;
  std::uint64_t bytes = 0;         ///< [byte] size of the new file
  std::vector<std::string> notes;  ///< messages for the user, e.g. about different builds
};

}  // namespace montecarta::engine
