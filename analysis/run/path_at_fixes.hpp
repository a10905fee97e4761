// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// The longest time [s] between the stored poses before and after a fix that is judged, because
/// estimates are interpolated linearly between them.
inline constexpr double kLongestGap = 1.0;

/// Times [s] that differ by no more than this count as the same: a fix at a stored pose is judged
/// beside any gap.
inline constexpr double kTimeAtPose = 1e-3;

/// The fixes of a reference at which an estimate exists, and the place of each between the rows of
/// an estimated path. All metrics of a recorded drive use these fixes: those within the drive's
/// time span that lie between stored poses at most kLongestGap apart, or at a stored pose. It is
/// the same for all runs of all cells; any number of threads may use it.
class PathAtFixes {
 public:
  /// Takes the `times` [s] of a path's rows, increasing; the vehicle stands at `start` at time 0,
  /// with the covariance (m, m, rad)^2 that filters are given. Fixes before time 0 or after the
  /// last row are not used.
  PathAtFixes(const ReferencePath& reference, std::span<const double> times, const Pose& start,
              const Eigen::Matrix3d& start_covariance = Eigen::Matrix3d::Zero());

  const std::string& name() const { return used_.name; }
  /// Number of fixes within the drive that are not used, because they lie in a longer gap.
  std::size_t in_gaps() const { return in_gaps_; }
  /// Number of fixes before time 0 or after the last row, which are not used either.
  std::size_t outside() const { return outside_; }
  /// Whether the reference states its own errors.
  bool has_errors() const { return has_errors_; }
  /// [s] {fix used} time of the fix.
  const std::vector<double>& times() const { return used_.time; }
  /// [m] {fix used} position of the fix.
  const std::vector<Eigen::Vector2d>& positions() const { return used_.position; }
  /// [rad] {fix used} heading; empty where the reference has none.
  const std::vector<double>& headings() const { return used_.heading; }

  /// Covariance of the start that filters are given, (m, m, rad)^2; zero if it is exact.
  const Eigen::Matrix3d& start_covariance() const { return start_covariance_; }
  /// {fix used} covariance, (m, m, rad)^2; empty if unknown.
  const std::vector<Eigen::Matrix3d>& covariances() const { return used_.covariance; }

  /// A place between row `next` - 1 (the start if `next` is 0) and row `next`.
  struct FixPlace {
    std::size_t next = 0;
    double share = 0.0;  ///< share of the way to row `next`, in [0, 1]
  };
  /// {fix used} place on the path.
  const std::vector<FixPlace>& places() const { return places_; }
  /// Returns whether the start was taken from a fix: whether it agrees with the first one within
  /// the drive to a micrometre.
  bool has_start() const { return has_start_; }

  /// Interpolates `path` {row, 3} [m, m, rad] linearly in time at every fix; the heading turns the
  /// shorter way.
  std::vector<Pose> interpolate(std::span<const double> path) const;

 private:
  static FixPlace place_of(double time, std::span<const double> times);

  Pose start_;
  Eigen::Matrix3d start_covariance_;
  ReferencePath used_;
  std::size_t in_gaps_ = 0, outside_ = 0;
  bool has_errors_;
  bool has_start_ = false;
  std::vector<FixPlace> places_;
};

}  // namespace montecarta::analysis
