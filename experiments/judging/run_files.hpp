// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The files of one estimator.
struct EstimatorFiles {
  std::string cell;                           ///< label of the cell
  std::vector<std::filesystem::path> of_run;  ///< {run} file of each run of JudgedFiles::runs
};

/// Estimates and truths, matched by run.
struct JudgedFiles {
  std::vector<std::uint64_t> runs;  ///< numbers of the runs, consecutive and increasing
  /// {run} names of runs that are numbered from 0: numbers in the names of the files that are not
  /// consecutive, e.g. seeds, or the words in which the paths differ; else empty.
  std::vector<std::string> names;
  std::vector<std::filesystem::path> truth;  ///< {run} files of the truth
  std::vector<EstimatorFiles> cells;         ///< files of the cells, ordered by label
};

/// Pairs estimates with truths by the numbers in their names (montecarta judge --help). `truths`
/// are files, folders that `export` made, or their folder truth/; without any, the estimates stand
/// in their place. `cell`, if given, is the label of all estimates, which may have names instead of
/// numbers then. Throws StudyError if a run occurs twice or is missing.
JudgedFiles pair_files(const std::vector<std::string>& estimates,
                       const std::vector<std::string>& truths,
                       const std::optional<std::string>& cell);

/// The files of two estimators (judge --pair), each in the place of its truth. Two files that are
/// not alike are two estimators with one run each, whatever numbers are in their names; they are
/// called by their files or, if these have the same name, by their folders.
JudgedFiles files_of_pair(const std::vector<std::string>& files);

/// Throws StudyError with this remedy if a cell cannot be called `label`.
void check_label(const std::string& label,
                 const std::string& remedy = "rename the folder, or give --cell NAME");

/// A sentence on runs that are numbered anew; empty if they are not.
std::string note_on_names(const JudgedFiles& files);

}  // namespace montecarta::experiments
