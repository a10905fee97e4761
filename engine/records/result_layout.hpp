// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/run_record.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::engine {

/// Where the runs of one dataset lie in a file: one behind the other, the first ones or all.
struct Slab {
  std::uint64_t offset = 0;     ///< [byte] of run index 0
  std::uint64_t run_bytes = 0;  ///< [byte] of one run
  std::size_t runs = 0;         ///< how many there are
  bool holds(std::size_t run_index) const { return run_index < runs; }
  std::uint64_t at(std::size_t run_index) const { return offset + run_index * run_bytes; }
};

/// Slabs of one cell.
struct CellSlabs {
  std::vector<Slab> columns;      ///< StoredCell::columns, behind them those of full runs only
  std::size_t usual_columns = 0;  ///< how many of them every run has
  Slab failure_reason, failure_step, fingerprint, cpu_seconds, status;
  Slab full_fingerprint;  ///< of no run where full runs have no more columns than others
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

/// What a reader wants to know of a dataset besides its numbers.
struct Label {
  std::string units;
  std::string long_name;
};

/// Dimension scales by the name of their dimension.
using Scales = std::map<std::string, h5::Handle, std::less<>>;

/// A dataset with its label over dimensions whose scales exist.
h5::Handle add_dataset(const h5::Handle& parent, const std::string& name, Element element,
                       const h5::Shape& shape, const std::vector<std::string>& dimensions,
                       const Label& label, const Scales& scales);
/// One text of at most `width` bytes; what it lacks is zeros.
h5::Handle add_text(const h5::Handle& parent, const std::string& name, const std::string& text,
                    std::size_t width, const Label& label);
/// Creates the scale of dimension `name`, which `scales` then holds in place of one of that name.
void add_scale(const h5::Handle& parent, const std::string& name, const std::vector<double>& values,
               const Label& label, Scales& scales);
void add_scale(const h5::Handle& parent, const std::string& name,
               const std::vector<std::uint64_t>& values, const Label& label, Scales& scales);
/// A scale that counts 0, 1, ..., length - 1.
void add_index_scale(const h5::Handle& parent, const std::string& name, std::size_t length,
                     const Label& label, Scales& scales);

/// Names and widths on which the writer of a result file and its reader agree (analysis/FORMAT.md).
namespace format {
inline constexpr std::string_view kFiletype = "montecarta-results";
inline constexpr std::uint64_t kMajor = 1;           ///< grows when a meaning changes
inline constexpr std::uint64_t kMinor = 9;           ///< grows when something is added
inline constexpr std::size_t kSittingsBytes = 4096;  ///< room for the log of resumptions
inline constexpr const char* kFull = "full";         ///< group of a cell: columns of full runs only
inline constexpr const char* kFullRun = "full_run";  ///< their first axis
inline constexpr const char* kFullRuns = "full_runs";  ///< attribute: how many the study has
/// Fact of /provenance: --force allowed finishing to replace what had the final name.
inline constexpr std::string_view kReplaces = "replaces";
}  // namespace format

/// Creates at `path` a complete, closed result file in which every run is missing: all groups,
/// attributes and scales, and for every dataset its final place. Throws RunError where the disk
/// fails.
void lay_out(const std::filesystem::path& path, const ResultDescription& description);

/// Writes all that a result file says of itself into a new file. `add_runs` adds truth, cells and
/// timing, whose scales are in `scales` then.
void write_schema(const h5::Handle& file, const ResultDescription& description, Scales& scales,
                  const std::function<void()>& add_runs);

/// Reads the same. Throws StudyError where something that must be there cannot be read.
void read_schema(const h5::Handle& file, ResultDescription& description);

/// Throws StudyError unless all that a file says of itself goes together: every number in it that
/// is an index, a count or a time of others is one, and all columns of a cell have the same axes.
void check_description(const ResultDescription& description, const std::filesystem::path& path);

/// What an open result file says of itself. Throws StudyError where it is no montecarta result of a
/// known major version, RunError where something that must be there cannot be read, or contradicts
/// what else is there (check_description()).
ResultDescription read_description(const h5::Handle& file, const std::filesystem::path& path);

}  // namespace montecarta::engine
