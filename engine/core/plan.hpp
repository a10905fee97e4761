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
#include <string>
#include <utility>
#include <vector>

namespace montecarta::engine {

/// What a study may ask to be stored (study file: record.columns) besides the columns of the group
/// `pose` (records/columns.cpp), which are always stored.
struct ColumnSelection {
  bool covariance =
      true;  ///< pose_covariance; pose_mean_mixture, pose_covariance_mixture where there is one
  bool ancestry = true;      ///< ancestor
  bool particles = false;    ///< particle_pose, log_weight
  bool association = false;  ///< association_correct, _wrong, _new_again, _missed, _clutter
  bool map = false;          ///< map_mean, map_covariance, map_seen, at every scan
  bool final_map = false;    ///< final_map_mean, final_map_covariance, final_map_seen, at the last
  bool joint = false;        ///< joint_mean, joint_covariance of filters that have a joint estimate
  bool observability = false;    ///< rotation_information of filters that tell it
  std::size_t joint_scans = 16;  ///< record.joint_scans: at so many scans (joint_scans_of())
  bool scans_only = false;       ///< record.rate = scan: rows of `time` only where a scan was taken
};

/// One filter in one setting, repeated in runs: one curve of a figure.
struct Cell {
  std::string label;  ///< unique in the study, made of what distinguishes it, e.g. "fastslam2_m100"
  std::string filter;                 ///< name as users type it, e.g. "fastslam2"
  std::string long_name;              ///< e.g. "FastSLAM II, 100 particles"
  std::size_t particles = 0;          ///< 0: not a particle filter
  bool mixture = false;               ///< whether estimate() has a mixture between sampling
  bool joint = false;                 ///< whether joint() gives anything
  bool rotation_information = false;  ///< whether ScanReport has it
  std::size_t landmarks = 0;          ///< how many rows the map columns have
  /// Components of the error that is stored of an estimate of another program; 0: a filter of ours.
  std::size_t error_components = 0;
  bool innovations = true;  ///< of such an estimate: whether its NIS is stored too
  /// Of such an estimate: whether its error may be by several conventions (kErrorConventions).
  bool several_conventions = false;
  bool poses = true;  ///< whether it estimates a pose in the plane; else only its error is stored
  std::vector<std::pair<std::string, std::string>> settings;  ///< resolved, every one, for the file
  std::function<std::unique_ptr<SlamFilter>()> make_filter;   ///< callable from any thread
};

/// Asked between rounds (monte_carlo.hpp), when the first `runs` runs of a cell have ended, whether
/// they are enough. Must follow from those runs, as they are stored in `unfinished`, and nothing
/// else.
using EnoughRuns = std::function<bool(const std::filesystem::path& unfinished, std::size_t cell,
                                      std::uint64_t runs, const Parallel& parallel)>;

/// A study made ready to run: what experiments hand to the engine. Results are a pure function of
/// it.
struct StudyPlan {
  std::string name;
  std::string title;  ///< one line for figures and the file's title attribute
  std::uint64_t seed = 0;
  std::uint64_t runs = 0;       ///< of the whole study
  std::uint64_t first_run = 0;  ///< this file holds runs [first_run, last_run)
  std::uint64_t last_run = 0;
  std::vector<Cell> cells;
  ColumnSelection columns;
  std::shared_ptr<const DriveSource> drives;
  EnoughRuns is_enough;  ///< when a cell stops early; empty: never. For files that hold all runs
  /// [m] True landmarks of a run, as many as the itinerary's, where every run has its own; empty
  /// where all have the itinerary's. Callable from any thread.
  std::function<std::vector<Eigen::Vector2d>(std::uint64_t run)> own_landmarks;
  std::vector<std::pair<std::string, std::string>> scenario;  ///< resolved settings, for the file
  std::string
      resolved_text;  ///< the study file with everything filled in; its SHA-256 names the study

  std::uint64_t runs_here() const { return last_run - first_run; }
};

}  // namespace montecarta::engine
