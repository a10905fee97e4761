// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/cramer_rao.hpp"
#include "analysis/run/imported_state.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "engine/records/result_file.hpp"
#include "engine/threads/parallel.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// An independent measurement of the path, as far as estimates are judged by it.
struct JudgedReference {
  std::string name;
  std::vector<double>
      times;               ///< [s] of the fixes within the drive; empty where runs have their own
  std::size_t fixes = 0;   ///< within the drive, or within all of several
  std::size_t drives = 0;  ///< that have fixes
  bool has_heading = false;
  bool has_errors = false;  ///< whether its own errors are known: then it gives a NEES
  bool has_start = false;   ///< whether the drive starts at one of its fixes

  /// What cells are compared by: raw distances where the errors of the reference are known, which
  /// makes it one in the frame of the drive; else aligned ones, since nobody knows the start.
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
  std::uint64_t study_runs = 0;      ///< of the whole study
  std::uint64_t runs_here = 0;       ///< held by the file
  double level = kUsualLevel;        ///< of all NEES bounds
  double within = kUsualMargin;      ///< what counts as consistent (judge())
  std::vector<std::uint64_t> looks;  ///< looks_in(): runs at each, where cells stop by verdict
  double duration = 0.0;             ///< [s] time of the last scan
  std::vector<double> times;         ///< [s] of the scans
  std::vector<double> joint_times;   ///< [s] of the scans at which joint estimates are stored
  bool has_truth = true;       ///< whether errors are known: without a true path no errors, no NEES
  std::size_t own_drives = 0;  ///< runs, where every run is a recorded drive of its own; else 0
  ImportedState imported;      ///< of files that 'montecarta judge' made
  std::vector<JudgedReference> references;  ///< of a recorded drive; the first one leads
  std::size_t beacons = 0;                  ///< landmarks whose true positions are known
  CramerRaoBound bound;                     ///< below which no error can be
  std::vector<CellAnalysis> cells;

  bool has_failures() const;
  /// "200 scans each", "up to 200 scans".
  std::string scans_text() const;
};

/// Analyses a result file run by run: memory does not grow with the number of runs. The same
/// numbers come out for any number of threads. `within` is what counts as consistent (judge()); the
/// study's own where it is not given. Throws StudyError where level is not inside (0, 1).
StudyAnalysis analyze(const ResultFile& file, double level = kUsualLevel,
                      const Parallel& parallel = Parallel::serial(),
                      std::optional<double> within = std::nullopt);

/// One cell of a file by its first `runs` runs alone, as analyze() has it but for what it has of
/// the study (efficiency). The file may be unfinished.
CellAnalysis analyze_cell(const ResultFile& file, const StoredCell& cell, double level,
                          std::size_t runs, const Parallel& parallel,
                          std::optional<double> within = std::nullopt);

}  // namespace montecarta::analysis
