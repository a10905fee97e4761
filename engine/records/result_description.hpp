// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/core/pose.hpp"
#include "engine/records/columns.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::engine {

/// (name, value), in order.
using TextPairs = std::vector<std::pair<std::string, std::string>>;

/// A cell as a result file describes it.
struct StoredCell {
  std::string label;
  std::string filter;
  std::string long_name;
  std::size_t particles = 0;
  TextPairs settings;
  std::vector<Column> columns;       ///< what was stored of every run
  std::vector<Column> full_columns;  ///< what was stored besides of the first runs
  /// Whether it was stored of every run.
  bool has(std::string_view column) const;
  /// As it was stored, of every run or of the first ones; nullptr where it was not.
  const Column* find(std::string_view column) const;
};

/// A recorded drive that is a run by itself.
struct OwnDrive {
  Pose start;                             ///< before the first step
  std::vector<double> scan_times;         ///< [s], at most as many as the file has scans
  std::vector<std::uint32_t> scan_steps;  ///< step after which each scan is taken
  std::vector<ReferencePath> references;  ///< of the same names in all drives
};

/// All that a result file says besides the numbers of its runs: from a plan it says how to lay a
/// file out, from a file what lies in it.
struct ResultDescription {
  std::string study_name;
  std::string title;
  std::string study_text;    ///< resolved study file
  std::string study_sha256;  ///< of study_text, hexadecimal: two files of one study agree in it
  std::uint64_t seed = 0;
  std::uint64_t study_runs = 0;                      ///< of the whole study
  std::uint64_t full_runs = 0;                       ///< of them so many, the first, in full
  std::vector<std::uint64_t> runs;                   ///< numbers of the runs held here, increasing
  std::vector<double> times;                         ///< [s] of the rows of `time`
  std::vector<double> scan_times;                    ///< [s]
  std::vector<std::uint32_t> scan_steps;             ///< step after which each scan is taken
  std::vector<std::uint32_t> scan_rows;              ///< row of `time` at which each scan is taken
  std::vector<std::uint32_t> joint_scans;            ///< of which joint estimates are stored
  Pose start;                                        ///< before the first step
  std::vector<std::pair<double, double>> landmarks;  ///< [m] true positions; empty where unknown
  std::vector<std::pair<double, double>> waypoints;  ///< [m]; may be empty
  std::vector<ReferencePath> references;             ///< by which a recorded drive is judged
  std::vector<OwnDrive> drives;  ///< {run of the study} where every run is a drive of its own:
                                 ///< then `references` is empty, and times are of the longest
  bool has_truth = true;         ///< whether true poses are stored
  bool own_landmarks = false;    ///< whether true landmarks of runs are stored
  TextPairs scenario;
  TextPairs provenance;
  std::vector<StoredCell> cells;

  /// How many runs of this file are stored in full: its first ones.
  std::size_t full_runs_here() const;
  /// Bytes of the numbers of all runs, over all cells and the truth.
  double bytes() const;
};

/// What the file of a plan will say.
ResultDescription describe(const StudyPlan& plan, const TextPairs& provenance);

}  // namespace montecarta::engine
