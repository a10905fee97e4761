// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/cell_sums.hpp"
#include "engine/records/sum_groups.hpp"

#include <cstdint>
#include <vector>

/// Sums over groups of runs that are stored instead of the runs (if record.columns has sums).
namespace montecarta::analysis {

/// Level of the bounds in stored sums.
inline constexpr double kStoredLevel = kUsualLevel;

/// Number of runs that a file holds, in rows or in sums.
std::uint64_t runs_in(const ResultFile& file);

/// {cell} The sums over all runs of `rows`, which are one group of a study.
std::vector<NewGroup> sums_to_store(const ResultFile& rows, const Parallel& parallel);

/// [byte] Approximate size of the sums over `runs` runs of a cell with `scans` scans.
double bytes_of_sums(std::uint64_t runs, std::size_t scans);

/// {run} The fingerprints of all runs of a cell whose rows are not stored, complete or failed.
/// Throws StudyError as read_stored_sums() does.
std::vector<std::uint64_t> fingerprints_in_sums(const ResultFile& file, const StoredCell& cell);

/// The sums of a cell of a file.
struct StoredSums {
  std::vector<std::uint64_t> complete;  ///< numbers of the complete runs
  std::vector<FailedRun> failures;
  CellSums sums;
};

/// Reads the sums of all groups of a cell. Throws StudyError if another version of this program
/// wrote them, or if they are damaged. The criteria must have the level kStoredLevel.
StoredSums read_stored_sums(const ResultFile& file, const StoredCell& cell,
                            const RunCriteria& criteria, const Parallel& parallel);

}  // namespace montecarta::analysis
