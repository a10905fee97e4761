// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/smoothing/elimination.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace montecarta::filters {

/// First row of the i-th of some poses.
inline Eigen::Index row_of_pose(std::size_t i) { return 3 * static_cast<Eigen::Index>(i); }

/// Covariance of some poses and all landmarks, by all that was measured (EQUATIONS (21.8),
/// (21.9)): given the landmarks, the last poses of segments are a Markov chain.
class PosesGivenMap {
 public:
  /// Of the last poses of the segments `chosen`, in order, three rows [m, m, rad] each, and of the
  /// landmarks, two rows [m] each, in the map frame.
  Eigen::MatrixXd covariance(const Elimination& elimination, std::span<const std::size_t> chosen);

 private:
  using Rows = Segment::Rows;

  /// The last pose of a segment, given the pose before it, the landmarks and all that was measured:
  /// x = transition x_before + by_landmarks' l + N(0, covariance), but for a constant.
  struct Step {
    Eigen::Matrix3d transition;
    Eigen::Matrix3d covariance;
    Rows by_landmarks;  ///< {row of l, 3}
  };

  void step_backwards(const Elimination& elimination, Eigen::Index rows);

  std::vector<Step> steps_;  ///< {segment}
  MapMoments map_;
};

}  // namespace montecarta::filters
