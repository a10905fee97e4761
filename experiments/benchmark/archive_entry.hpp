// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/render/page/html.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/result_file.hpp"
#include "engine/threads/parallel.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// The result of one filter in one world of the benchmark in a file of at most 30 kB, from which it
/// is drawn, compared run by run and computed again (experiments/BENCHMARK.md, "The archive").
namespace montecarta::experiments {

/// Number of successive runs that have one fingerprint, and are computed again together.
inline constexpr std::uint64_t kRunsOfArchivedBlock = 64;

/// The scores that are archived of every run.
inline constexpr std::array kArchivedScores = {"position_rmse", "heading_rmse", "nees"};
inline constexpr std::size_t kArchivedPositionRmse = 0;
inline constexpr std::size_t kArchivedNees = 2;

/// {score}{run} Scores as archived() keeps them; NaN where a run failed.
using ArchivedScores = std::array<std::vector<double>, kArchivedScores.size()>;

/// A score as the archive keeps it: a number of 24 bits, with 15 bits behind the leading one.
double archived(double score);

/// A verdict in a few numbers.
struct ArchivedVerdict {
  Answer answer = Answer::untested;
  bool is_slight = false;
  double within = 0.0, level = 0.0;
  double ratio = kNaN;  ///< NEES ratio; NaN if it is not tested
  Interval interval = {kNaN, kNaN};
  analysis::Json families = {};  ///< {family} name, p-value and strongest member
};

struct ArchiveEntry {
  std::string world = {};
  std::string label = {};   ///< label of the cell, and name of the file
  std::string filter = {};  ///< name of the filter in study files
  std::string cell = {};    ///< value of `cell` in a study file that gives this filter
  /// Files that the command of an external program names, with their SHA-256.
  std::vector<std::pair<std::string, std::string>> program_files = {};
  std::string study_sha256 = {};
  std::string drives_sha256 = {};
  std::uint64_t seed = 0, runs = 0, failed = 0;
  std::string first_failure = {};  ///< reason of the first failed run; empty if none failed
  ArchivedVerdict verdict = {};
  double cpu_seconds = kNaN;  ///< [s] cpu_seconds_of(), which is no part of the result
  std::vector<std::pair<std::string, std::string>> made_by = {};  ///< version, compiler, processor
  std::vector<std::uint64_t> blocks = {};  ///< {block} fingerprint of its runs
  ArchivedScores scores = {};

  /// Mean over the complete runs of the RMSE of the position [m].
  double position_rmse() const;
};

/// What the provenance of a result has about the files of its program, and back.
TextPairs provenance_of_files(const TextPairs& program_files);
TextPairs program_files_in(const TextPairs& provenance);

/// [s] Mean processor time of a run; NaN for an external program, whose time is not measured.
double cpu_seconds_of(const CellAnalysis& cell);

ArchivedVerdict verdict_in_short(const Verdict& verdict);

/// {score}{run} The scores of runs 0 to `runs`, which a cell may have in part.
ArchivedScores scores_of_runs(const CellAnalysis& cell, std::uint64_t runs);

/// The fingerprint of a block of runs by those of the runs.
std::uint64_t block_fingerprint(std::span<const std::uint64_t> of_runs);

/// The entry of a result that has one cell and sums of all its runs.
ArchiveEntry entry_of(const ResultFile& result, const std::string& world, const std::string& cell,
                      const Parallel& parallel);

/// The text of an entry (JSON), with which equal results have equal texts but for `made_by` and
/// processor times.
std::string text_of(const ArchiveEntry& entry);

/// Writes an entry to FOLDER/WORLD/LABEL.json, replacing an earlier one.
void write_entry(const ArchiveEntry& entry, const std::filesystem::path& folder);
std::filesystem::path path_of_entry(const std::filesystem::path& folder, const std::string& world,
                                    const std::string& label);

/// Reads an entry. Throws StudyError with file and remedy if the file is no entry, is damaged, has
/// another name than its cell, or lies in the folder of another world.
ArchiveEntry read_entry(const std::filesystem::path& path);

/// The entries FOLDER/*.json of one world, in the order of labels.
std::vector<ArchiveEntry> read_entries_of_world(const std::filesystem::path& folder);

/// All entries in FOLDER/WORLD/*.json of the worlds of the benchmark, in the order of worlds, then
/// of labels.
std::vector<ArchiveEntry> read_entries(const std::filesystem::path& folder);

/// The folder of the shipped archive.
std::filesystem::path shipped_archive();

}  // namespace montecarta::experiments
