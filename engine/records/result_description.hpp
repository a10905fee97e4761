// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/core/pose.hpp"
#include "engine/records/columns.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::engine {

/// Pairs (name, value), in order.
using TextPairs = std::vector<std::pair<std::string, std::string>>;

/// The description of a cell in a result file.
struct StoredCell {
  std::string label;
  std::string filter;
  std::string long_name;
  std::size_t particles = 0;
  TextPairs settings;
  std::vector<Column> columns;    ///< columns of every run, then those of the first runs only
  std::size_t usual_columns = 0;  ///< number of columns that every run has

  std::span<const Column> usual() const { return std::span(columns).first(usual_columns); }
  std::span<const Column> full() const { return std::span(columns).subspan(usual_columns); }
  /// Returns whether every run has the column.
  bool has(std::string_view column) const;
  /// The column of that name, of every run or of the first runs; nullptr if it is not stored.
  const Column* find(std::string_view column) const;
  /// Name of the dataset of column `c` in the file.
  std::string dataset_of(std::size_t c) const;
};

/// A recorded drive that is one run of the study.
struct OwnDrive {
  Pose start;                             ///< pose before the first step
  std::vector<double> scan_times;         ///< [s] {scan} at most as many as the file has scans
  std::vector<std::uint32_t> scan_steps;  ///< step after which each scan is taken
  std::vector<ReferencePath> references;  ///< references, with the same names in all drives
  /// [s] {row} time of each row of this drive if rows are steps; empty if rows are scans.
  std::vector<double> step_times = {};
};

/// Runs whose sums over groups a file holds instead of rows.
struct SummedRuns {
  std::uint64_t first_run = 0, last_run = 0;  ///< numbers of the runs: [first_run, last_run)
  std::vector<std::uint64_t> words;           ///< {cell} number of words of all groups
};

/// The contents of a result file except the numbers of its runs. Made from a plan it defines the
/// layout of a file, read from a file it describes that layout.
struct ResultDescription {
  std::string study_name;
  std::string title;
  std::string study_text;  ///< resolved study file
  std::string
      study_sha256;  ///< SHA-256 of study_text, hexadecimal; the same in all files of a study
  std::uint64_t seed = 0;
  std::uint64_t study_runs = 0;     ///< number of runs of the whole study
  std::uint64_t full_runs = 0;      ///< number of first runs of the study that are stored in full
  std::vector<std::uint64_t> runs;  ///< numbers of the runs in this file, increasing
  std::vector<double> times;        ///< [s] {row of `time`} time of each row
  std::vector<double> scan_times;   ///< [s] {scan} time of each scan
  std::vector<std::uint32_t> scan_steps;   ///< step after which each scan is taken
  std::vector<std::uint32_t> scan_rows;    ///< row of `time` at which each scan is taken
  std::vector<std::uint32_t> joint_scans;  ///< scans at which joint estimates are stored
  Pose start;                              ///< pose before the first step
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] true positions; empty if unknown
  std::vector<Eigen::Vector2d> waypoints;  ///< [m] way-points; may be empty
  std::vector<ReferencePath> references;   ///< references of a recorded drive
  /// {run of the study} drives if every run has its own, else empty. With drives, `references` is
  /// empty, and the times are those of the drive with the most scans.
  std::vector<OwnDrive> drives;
  bool has_truth = true;       ///< whether true poses are stored
  bool own_landmarks = false;  ///< whether true landmarks of runs are stored
  TextPairs scenario;
  TextPairs provenance;
  std::vector<StoredCell> cells;
  std::optional<SummedRuns> sums;  ///< sums over groups of runs; `runs` are then the first runs

  /// Number of runs of this file that are stored in full, which are its first ones.
  std::size_t full_runs_here() const;
  /// Size of the numbers of all runs, over all cells and the truth [byte].
  double bytes() const;
};

/// The description of the result file of a plan.
ResultDescription describe(const StudyPlan& plan, const TextPairs& provenance);

/// States why `b`, which describes the file `path`, is not of the same study and layout as `a`,
/// worded "place: problem (why): remedy"; nullopt if it is. Their runs may differ.
std::optional<std::string> difference(const ResultDescription& a, const ResultDescription& b,
                                      const std::filesystem::path& path);

/// Differences between two builds, worded for the user; empty if both round alike.
std::vector<std::string> build_differences(const TextPairs& a, const TextPairs& b);

}  // namespace montecarta::engine
