// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/run_record.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::engine {

/// The place of the runs of one dataset in a file, one run behind the other. It holds all runs or
/// the first ones.
struct Slab {
  std::uint64_t offset = 0;     ///< [byte] of run index 0
  std::uint64_t run_bytes = 0;  ///< [byte] of one run
  std::size_t runs = 0;         ///< number of runs
  bool holds(std::size_t run_index) const { return run_index < runs; }
  std::uint64_t at(std::size_t run_index) const { return offset + run_index * run_bytes; }
};

/// The slabs of one cell.
struct CellSlabs {
  std::vector<Slab> columns;      ///< in the order of StoredCell::columns
  std::size_t usual_columns = 0;  ///< number of columns that every run has
  Slab failure_reason, failure_step, fingerprint, cpu_seconds, status;
  Slab full_fingerprint;  ///< without runs if full runs have no further columns
};

/// The slabs of the true paths.
struct TruthSlabs {
  Slab pose, fingerprint;
  std::optional<Slab> landmarks;  ///< nullopt if all runs have those of the world
};

/// The slabs of a result file, with which runs are copied without HDF5.
struct ResultSlabs {
  std::optional<TruthSlabs> truth;  ///< nullopt if the truth is unknown
  Slab wall_seconds;                ///< one value for all runs
  Slab sittings;                    ///< one text for all runs
  std::vector<CellSlabs> cells;
  std::vector<Slab> sums;         ///< {cell} all groups; empty if the file has no sums
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
/// longest column. A run that is missing or spared must have no fingerprint.
bool run_is_whole(const PosixFile& file, const CellSlabs& cell, std::size_t run_index,
                  std::vector<std::byte>& buffer);
/// Returns whether the fingerprint of the true path of a run matches; false if it is missing, true
/// if the file stores no truth.
bool truth_is_whole(const PosixFile& file, const ResultSlabs& slabs, std::size_t run_index,
                    std::vector<std::byte>& buffer);

/// Names and widths that are shared by writer and reader of a result file (analysis/FORMAT.md).
namespace format {
inline constexpr std::string_view kFiletype = "montecarta-results";
inline constexpr std::uint64_t kMajor = 1;           ///< increased when a meaning changes
inline constexpr std::uint64_t kMinor = 10;          ///< increased when something is added
inline constexpr std::size_t kSittingsBytes = 4096;  ///< size of the log of resumptions
inline constexpr const char* kSums = "sums";         ///< group of the sums over groups of runs
/// Dataset in the timing of a cell: of every run in sums.
inline constexpr const char* kSumSeconds = "sums_cpu_seconds";
inline constexpr const char* kFull = "full";  ///< group of a cell for the columns of full runs only
inline constexpr const char* kFullRun = "full_run";    ///< first axis of those columns
inline constexpr const char* kFullRuns = "full_runs";  ///< attribute: their number in the study
/// Members of the group of a cell that are no columns.
inline constexpr std::array<std::string_view, 6> kBesideColumns = {
    "status", "failure_reason", "failure_step", "fingerprint", kFull, "settings"};
/// Fact in /provenance: --force was given, so finishing may replace the file with the final name.
inline constexpr std::string_view kReplaces = "replaces";
}  // namespace format

/// Creates a closed result file at `path` in which every run is missing. It has all groups,
/// attributes and scales, and the final place of every dataset. Throws RunError if the disk fails.
void lay_out(const std::filesystem::path& path, const ResultDescription& description);

/// Reads the description. Throws StudyError if a required part cannot be read.
void read_schema(const h5::Handle& file, ResultDescription& description);

/// Throws StudyError unless the parts of a description are consistent: every index, count and time
/// is valid, and all columns of a cell have the same axes.
void check_description(const ResultDescription& description, const std::filesystem::path& path);

/// Reads the description of an open result file. Throws StudyError if it is no montecarta result of
/// a known major version, and RunError if a required part cannot be read or is inconsistent
/// (check_description()).
ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path);
/// The same, of a file that is not open yet, after checking its seal.
ResultDescription read_description(const std::filesystem::path& path);

}  // namespace montecarta::engine
