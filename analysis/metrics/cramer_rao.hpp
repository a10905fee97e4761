// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/simulated_world.hpp"
#include "engine/records/result_file.hpp"
#include "engine/threads/parallel.hpp"

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Runs that the bound is averaged over where every run has a path of its own.
inline constexpr std::size_t kBoundRuns = 16;

/// The least root mean square error that is possible, just after each scan, of an estimator without
/// bias that knows which landmark is which. Empty where there is none. Where every run has a path
/// of its own it is no bound but what the linearised filter with its Jacobians at the truth reports
/// (STATISTICS 11): is_bound.
struct CramerRaoBound {
  std::vector<double> position;  ///< [m] {scan}
  std::vector<double> heading;   ///< [rad] {scan}
  double map =
      std::numeric_limits<double>::quiet_NaN();  ///< [m] at the end, RMS over the landmarks
                                                 ///< that came into view; NaN: none did
  std::size_t runs = 0;  ///< whose paths it is the average of; 1 where all runs share one path
  bool is_bound = true;  ///< false: a linearised reference
  std::string missing;   ///< why there is none

  bool empty() const { return position.empty(); }
  bool operator==(const CramerRaoBound&) const = default;
};

/// The bound of a result file. Where noise is on the controls that filters are given, the path is
/// the same in all runs, and so is the bound. Where noise moves the vehicle, it is a linearised
/// reference, the average over the paths of the first kBoundRuns runs with a complete cell.
CramerRaoBound cramer_rao_bound(const ResultFile& file,
                                const Parallel& parallel = Parallel::serial());

/// A path as rows of poses, and what of them are scans.
struct TruePath {
  Pose start;
  std::vector<Pose> rows;
  std::vector<std::size_t> steps;          ///< control steps from the row before, >= 1
  std::vector<double> durations;           ///< [s] of one of those steps
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] by identity
  std::vector<std::uint32_t> scan_rows;    ///< row of each scan
};

/// Squares of the bound along one path [m^2], [rad^2], [m^2]. Between rows that are several steps
/// apart all steps turn and advance alike. `missing` where it cannot be computed.
CramerRaoBound squared_bound(const SimulatedWorld& world, const TruePath& path);

struct CellAnalysis;

/// How near a cell comes to the Cramer-Rao bound: 1 is as good as any filter without bias can be.
/// NaN where there is no bound (a linearised reference is none) or no error.
struct Efficiency {
  /// Bound by error, each the root of its mean square over scans, that of the error also over runs.
  double position = std::numeric_limits<double>::quiet_NaN();
  double heading = std::numeric_limits<double>::quiet_NaN();
  /// Of the landmarks in the map at the end; needs known association.
  double map = std::numeric_limits<double>::quiet_NaN();
};

Efficiency efficiency_of(const CellAnalysis& cell, const CramerRaoBound& bound);

/// What the bound and efficiency say, or why there is none.
std::vector<std::string> bound_notes(const CramerRaoBound& bound);

}  // namespace montecarta::analysis
