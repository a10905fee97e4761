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

/// The place of the runs of one dataset in a file, one run behind the other. It holds all runs or
/// the first ones.
struct Slab {
  std::uint64_t offset = 0;     ///< [byte] offset of run index 0
  std::uint64_t run_bytes = 0;  ///< [byte] size of one run
  std::size_t runs = 0;         ///< number of runs
  bool holds(std::size_t run_index) const { return run_index < runs; }
  std::uint64_t at(std::size_t run_index) const { return offset + run_index * run_bytes; }
};

/// The slabs of one cell.
struct CellSlabs {
  std::vector<Slab> columns;      ///< slabs in the order of StoredCell::columns
  std::size_t usual_columns = 0;  ///< number of columns that every run has
  Slab failure_reason, failure_step, fingerprint, cpu_seconds, status;
  Slab full_fingerprint;  ///< fingerprints; has no runs if full runs have no further columns
};

/// The slabs of the true paths.
struct TruthSlabs {
  Slab pose, fingerprint;
  std::optional<Slab> landmarks;  ///< nullopt if all runs have those of the world
};

/// The slabs of a result file, with which runs are copied without HDF5.
struct ResultSlabs {
  std::optional<TruthSlabs> truth;  ///< nullopt if the truth is unknown
  Slab wall_seconds;                ///< wall time, one value for all runs
  Slab sessions;                    ///< log of resumptions, one text for all runs
  std::vector<CellSlabs> cells;
  std::vector<Slab> sums;         ///< {cell} sums of all groups; empty if the file has none
  std::vector<Slab> sum_seconds;  ///< {cell} processor time of every run in them [s]
};

/// Finds the slabs of the file at `path`, described by `description`. Throws StudyError if a
/// dataset is not contiguous, because another program rewrote the file.
ResultSlabs find_slabs(const std::filesystem::path& path, const ResultDescription& description);

/// The status of every run of a cell. Throws StudyError if a number is not a status.
std::vector<RunStatus> read_statuses(const PosixFile& file, const CellSlabs& cell,
                                     std::size_t runs);

RunStatus status_of(const PosixFile& file, const CellSlabs& cell, std::size_t run_index);

/// Returns whether the fingerprint stored with a run matches its bytes. `buffer` is used for the
/// longest column. A run that is missing or not needed must have no fingerprint.
bool run_is_whole(const PosixFile& file, const CellSlabs& cell, std::size_t run_index,
                  std::vector<std::byte>& buffer);
/// Returns whether the fingerprint of the true path of a run matches; false if it is missing, true
/// if the file stores no truth.
bool truth_is_whole(const PosixFile& file, const ResultSlabs& slabs, std::size_t run_index,
                    std::vector<std::byte>& buffer);

}  // namespace montecarta::engine
