// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/cramer_rao.hpp"
#include "analysis/run/imported_state.hpp"
#include "analysis/run/run_reader.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "engine/records/result_file.hpp"
#include "engine/threads/parallel.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// An independent measurement of the path, by which estimates are judged.
struct JudgedReference {
  std::string name;
  /// [s] {judged fix} times; empty if runs have drives of their own.
  std::vector<double> times;
  std::size_t fixes = 0;   ///< number of judged fixes (PathAtFixes), of all drives
  std::size_t drives = 0;  ///< number of drives that have fixes
  bool has_heading = false;
  bool has_errors = false;  ///< whether its own errors are known, so that there is a NEES
  bool has_start = false;   ///< whether the drive starts at one of its fixes
  std::size_t in_gaps = 0;  ///< number of fixes left out (PathAtFixes::in_gaps()), of all drives
  std::size_t outside = 0;  ///< number of fixes left out (PathAtFixes::outside()), of all drives
  std::size_t all_fixes() const { return fixes + in_gaps + outside; }

  /// Returns whether cells are compared by raw distances: then the errors of the reference are
  /// known, so it is in the frame of the drive. Else they are compared by aligned distances, since
  /// the start is not known exactly.
  bool compares_raw() const { return has_errors; }
  const char* compared() const { return compares_raw() ? "raw" : "aligned"; }
};

/// Metrics of every cell of a result file, evaluated at its scans, just after each update.
struct StudyAnalysis {
  std::string file;  ///< name of the result file, without folders
  std::string study_name;
  std::string title;
  std::string study_sha256;
  std::uint64_t seed = 0;
  std::uint64_t study_runs = 0;  ///< number of runs of the whole study
  std::uint64_t runs_here = 0;   ///< number of runs that the file holds
  double level = kUsualLevel;    ///< level of all NEES bounds and tests
  double within = kUsualMargin;  ///< margin of consistent ratios (judge())
  /// {interim analysis} number of runs; empty if there is only one.
  std::vector<std::uint64_t> runs_at_analyses;
  double duration = 0.0;            ///< [s] time of the last scan
  JudgedScans judged;               ///< scans that count; all others are left out everywhere
  std::vector<double> times;        ///< [s] {judged scan} time of each scan
  std::vector<double> joint_times;  ///< [s] {scan with joint estimates} time of each of these scans
  /// Whether the true path is known: without it there are no errors and no NEES.
  bool has_truth = true;
  bool rows_are_scans = true;  ///< whether poses are stored at scans only (record.rate = scan)
  std::size_t own_drives = 0;  ///< number of runs if each is a recorded drive of its own; else 0
  ImportedState imported;      ///< state of files that 'montecarta judge' made
  std::string odometry;        ///< time, way and gaps of a recorded drive by its odometry, or empty
  std::vector<JudgedReference> references;  ///< references of a recorded drive; the first one leads
  std::size_t beacons = 0;                  ///< number of landmarks whose true positions are known
  CramerRaoBound bound;                     ///< least error of any filter without bias
  std::vector<CellAnalysis> cells;

  bool has_failures() const;
  /// Number of scans in words: "200 scans each", "up to 200 scans", and from when on they are
  /// judged.
  std::string scans_text() const;
};

/// Analyses a result file run by run: memory does not grow with the number of runs. The results do
/// not depend on the number of threads. `within` is the margin of consistent ratios (judge()); by
/// default it is that of the study. Throws StudyError if level is not inside (0, 1).
StudyAnalysis analyze(const ResultFile& file, double level = kUsualLevel,
                      const Parallel& parallel = Parallel::serial(),
                      std::optional<double> within = std::nullopt);

/// Analyses one cell of a file by its first `runs` runs. The result is that of analyze() without
/// what needs the other cells (efficiency). The file may be unfinished.
CellAnalysis analyze_cell(const ResultFile& file, const StoredCell& cell, double level,
                          std::size_t runs, const Parallel& parallel,
                          std::optional<double> within = std::nullopt);

}  // namespace montecarta::analysis
