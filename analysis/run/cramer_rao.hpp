// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/simulated_world.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/core/pose.hpp"
#include "engine/records/result_file.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Number of runs over which the bound is averaged if every run has a path of its own.
inline constexpr std::size_t kBoundRuns = 16;

/// The least root mean square error, just after each scan, of any estimator without bias that knows
/// which landmark is which. Empty if it cannot be computed. If every run has a path of its own
/// (is_bound is false), the numbers are no bound but the covariance that a linearised filter with
/// Jacobians at the truth reports (STATISTICS 11).
struct CramerRaoBound {
  std::vector<double> position;  ///< [m] {judged scan} least RMS error of the position
  std::vector<double> heading;   ///< [rad] {judged scan} least RMS error of the heading
  /// [m] at the end, RMS over the landmarks that came into view; NaN if none did.
  double map = kNaN;
  std::size_t runs = 0;  ///< number of averaged paths; 1 if all runs share one path
  bool is_bound = true;  ///< false if the numbers are a linearised reference
  std::string missing;   ///< reason why there is no bound

  bool empty() const { return position.empty(); }
  bool operator==(const CramerRaoBound&) const = default;
};

/// A true path as rows of poses, with the rows of the scans.
struct TruePath {
  Pose start;
  std::vector<Pose> rows;
  std::vector<std::size_t> steps;          ///< number of control steps from the row before, >= 1
  std::vector<double> durations;           ///< [s] duration of one of those steps
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] true positions by identity
  std::vector<std::uint32_t> scan_rows;    ///< {scan} row of the path
};

/// Squares of the bound along one path, [m^2], [rad^2] and [m^2]. All control steps between two
/// rows are taken to turn and advance alike. `missing` states why it cannot be computed.
CramerRaoBound squared_bound(const SimulatedWorld& world, const TruePath& path);

/// The bound of a result file. If the noise is on the controls that filters receive, the path is
/// the same in all runs, and so is the bound if the landmarks are; otherwise it is averaged over
/// the first kBoundRuns runs with a complete cell. If noise moves the vehicle, the average is a
/// linearised reference.
class BoundOfStudy {
 public:
  explicit BoundOfStudy(const ResultFile& file);

  std::size_t paths() const { return paths_.size(); }
  /// Computes the bound along path `i`. Any number of threads may do so, each along its own.
  void follow(std::size_t i) { squares_[i] = squared_bound(*world_, paths_[i]); }
  /// The bound, once every path has been followed.
  CramerRaoBound result() const;

 private:
  std::optional<SimulatedWorld> world_;
  std::ptrdiff_t first_judged_;  ///< number of the first scan that is judged
  std::vector<TruePath> paths_;
  std::vector<CramerRaoBound> squares_;  ///< {path} squared bounds
  std::string missing_;                  ///< reason why there is no path
};

}  // namespace montecarta::analysis
