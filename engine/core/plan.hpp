// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/slam_filter.hpp"
#include "engine/namespaces.hpp"
#include "engine/threads/parallel.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::engine {

/// The columns that a study stores (study file: record.columns) in addition to those of the group
/// `pose` (records/columns.cpp), which are always stored.
struct ColumnSelection {
  bool covariance =
      true;  ///< pose_covariance and, with a mixture, pose_mean_mixture, pose_covariance_mixture
  bool ancestry = true;    ///< column ancestor
  bool particles = false;  ///< columns particle_pose and log_weight
  /// Columns association_correct, _wrong, _new_again, _missed and _clutter.
  bool association = false;
  bool map = false;  ///< columns map_mean, map_covariance and map_seen, at every scan
  /// Columns final_map_mean, final_map_covariance and final_map_seen, at the last scan.
  bool final_map = false;
  bool joint = false;  ///< columns joint_mean and joint_covariance of filters with a joint estimate
  bool observability = false;    ///< columns about observability that filters declare themselves
  bool evolution = false;        ///< columns about evolution that filters declare themselves
  std::size_t joint_scans = 16;  ///< record.joint_scans: number of scans (joint_scans_of())
  bool scans_only = false;       ///< record.rate = scan: rows of `time` only at scans
  /// record.full_runs: number of first runs of the study that are stored with the columns of
  /// in_full().
  std::uint64_t full_runs = 0;
  /// Sums over groups of kRunsOfAGroup runs are stored in place of their rows.
  bool sums = false;
};

/// Consecutive runs of a study, by their numbers, that are summed up before anything else: groups
/// begin at the multiples of this number.
inline constexpr std::uint64_t kRunsOfAGroup = 4096;
/// Least number of first runs whose rows are stored beside sums.
inline constexpr std::uint64_t kRunsBesideSums = 16;

/// The error of another program's estimate, which a file holds in place of our own columns.
struct ImportedError {
  std::size_t components = 0;
  bool has_innovations = false;
  /// Number of conventions that the error may follow, the first of kErrorConventions; 0 if its
  /// definition is certain.
  std::size_t conventions = 0;
  bool has_pose = false;  ///< the estimate is a pose in the plane, and stored as well
};

/// Fact of the scenario of a recorded drive: its time, way and gaps by the odometry, in words.
inline constexpr const char* kOdometryFact = "odometry";

/// One filter in one setting, repeated in runs; one curve of a figure.
struct Cell {
  std::string label;  ///< label, unique in the study, of the settings that differ: "fastslam2_m100"
  std::string filter;         ///< name in study files, for instance "fastslam2"
  std::string long_name;      ///< name for readers, for instance "FastSLAM II, 100 particles"
  std::size_t particles = 0;  ///< number of particles; 0 if it is not a particle filter
  Capabilities reports;
  std::size_t landmarks = 0;                   ///< number of rows of the map columns
  std::optional<ImportedError> imported = {};  ///< nullopt for our own filters
  /// Whether the estimates depend on the drive alone, and not on random numbers of the run.
  bool is_deterministic = false;
  /// All resolved settings for the file.
  std::vector<std::pair<std::string, std::string>> settings;
  std::function<std::unique_ptr<SlamFilter>()> make_filter;  ///< makes the filter, on any thread
};

/// Called between two rounds (monte_carlo.hpp), when the first `runs` runs of a cell have ended.
/// Returns whether they are enough, which may depend on those runs alone, as stored in
/// `unfinished`.
using EnoughRuns = std::function<bool(const std::filesystem::path& unfinished, std::size_t cell,
                                      std::uint64_t runs, const Parallel& parallel)>;

/// A study that is ready to run, the input of the engine. Results are a pure function of it.
struct StudyPlan {
  std::string name;
  std::string title;  ///< one line for figures and the file's title attribute
  std::uint64_t seed = 0;
  std::uint64_t runs = 0;       ///< number of runs of the whole study
  std::uint64_t first_run = 0;  ///< the file holds runs [first_run, last_run)
  std::uint64_t last_run = 0;
  std::vector<Cell> cells;
  ColumnSelection columns;
  std::shared_ptr<const DriveSource> drives;
  /// Rule by which a cell stops early; empty: never. Only files with all runs may have one.
  EnoughRuns is_enough;
  /// Returns the true landmarks [m] of a run, as many as in the itinerary, if every run has its
  /// own; empty if all runs have those of the itinerary. It may be called from any thread.
  std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks;
  /// Resolved settings of the scenario for the file.
  std::vector<std::pair<std::string, std::string>> scenario;
  std::string resolved_text;  ///< study file with all defaults; its SHA-256 identifies the study

  std::uint64_t runs_here() const { return last_run - first_run; }
};

}  // namespace montecarta::engine
