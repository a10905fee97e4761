// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/run_record.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace montecarta::engine {

/// Where the runs of one dataset lie in a file: one behind the other.
struct Slab {
  std::uint64_t offset = 0;     ///< [byte] of run index 0
  std::uint64_t run_bytes = 0;  ///< [byte] of one run
  std::uint64_t at(std::size_t run_index) const { return offset + run_index * run_bytes; }
};

/// Slabs of one cell.
struct CellSlabs {
  std::vector<Slab> columns;  ///< in the order of StoredCell::columns
  Slab failure_reason, failure_step, fingerprint, cpu_seconds, status;
};

/// Slabs of the true paths.
struct TruthSlabs {
  Slab pose, fingerprint;
  std::optional<Slab> landmarks;  ///< nullopt where all runs have the world's
};

/// Slabs of a result file: what one needs to move runs without HDF5.
struct ResultSlabs {
  std::optional<TruthSlabs> truth;  ///< nullopt where nobody knows it
  Slab wall_seconds;                ///< one value, not one a run
  Slab sittings;                    ///< one text, not one a run
  std::vector<CellSlabs> cells;
};

/// Finds the slabs of the file at `path`, described by `description`. Throws StudyError where a
/// tool rewrote the file so that a dataset does not lie in one piece.
ResultSlabs find_slabs(const std::filesystem::path& path, const ResultDescription& description);

/// Status of every run of a cell. Throws StudyError where a number is none.
std::vector<RunStatus> read_statuses(const PosixFile& file, const CellSlabs& cell,
                                     std::size_t runs);

RunStatus status_of(const PosixFile& file, const CellSlabs& cell, std::size_t run_index);

/// Whether the fingerprint stored with a run is that of its bytes, which needs `buffer` for the
/// longest column. A run that is missing or was spared has none.
bool run_is_whole(const PosixFile& file, const CellSlabs& cell, std::size_t run_index,
                  std::vector<std::byte>& buffer);
/// The same for its true path; false where it is missing, true where there is none to store.
bool truth_is_whole(const PosixFile& file, const ResultSlabs& slabs, std::size_t run_index,
                    std::vector<std::byte>& buffer);

}  // namespace montecarta::engine
