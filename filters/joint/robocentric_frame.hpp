// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/compressed_gaussian.hpp"

#include <Eigen/Core>

#include <cstddef>

namespace montecarta::filters {

/// The frame of the map as a part of the state, for a Gaussian whose errors are relative to the
/// vehicle (EQUATIONS (15.16); Castellanos, Martinez-Cantin, Tardos, Neira, RAS 2007). Two points
/// of the Gaussian, slots 0 and 1, are the place where the vehicle started and one 1 m beside it;
/// the second differs from the first by the frame's heading alone.
class RobocentricFrame {
 public:
  /// Adds those two points to `gaussian`, which is empty and stands at `start`.
  void start(const Pose& start, CompressedGaussian& gaussian);
  /// The detections of a scan are used: from now on errors are relative to this pose, which has
  /// none. All landmarks are near then.
  void centre(CompressedGaussian& gaussian);

  /// Moments in the map, in the first order, of a pose whose errors are independent of the frame's.
  PoseMoments in_map(const PoseMoments& pose) const;
  /// Of a landmark; the Gaussian was just centred.
  LandmarkEstimate in_map(const CompressedGaussian& gaussian, std::size_t slot) const;
  /// Of pose and all points; the rows of slots 0 and 1 lose their meaning.
  void put_in_map(JointEstimate& joint) const;

 private:
  Eigen::Matrix2d to_map() const;
  Eigen::Vector2d place_in_map(const Eigen::Vector2d& place) const;
  Eigen::Matrix<double, 2, 3> by_frame(const Eigen::Vector2d& place) const;

  Eigen::Vector2d start_;       ///< [m] in the map
  Eigen::Vector2d origin_;      ///< [m] the first point
  Eigen::Vector2d axis_;        ///< from it to the second
  double heading_ = 0.0;        ///< [rad] of the axis
  Eigen::Matrix3d covariance_;  ///< of origin and heading
};

}  // namespace montecarta::filters
