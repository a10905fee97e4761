// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/compressed_gaussian.hpp"

#include <Eigen/Core>

#include <cstddef>

namespace montecarta::filters {

/// The frame of the map as a part of the state, for a Gaussian with errors relative to the vehicle
/// (EQUATIONS (15.16); Castellanos, Martinez-Cantin, Tardos, Neira, RAS 2007). Two points, in slots
/// 0 and 1, represent it: the start of the vehicle and a point 1 m beside it. The error of the
/// second differs from that of the first only by the heading of the frame.
class RobocentricFrame {
 public:
  /// Adds the two points to `gaussian`, which must be empty and at `start`.
  void start(const Pose& start, CompressedGaussian& gaussian);
  /// Makes errors relative to the present pose, after the detections of a scan have been used. All
  /// landmarks become near.
  void centre(CompressedGaussian& gaussian);

  /// Moments in the map, to first order, of a pose with errors independent of those of the frame.
  PoseMoments in_map(const PoseMoments& pose) const;
  /// Moments in the map of a landmark; `gaussian` must just have been centred.
  LandmarkEstimate in_map(const CompressedGaussian& gaussian, std::size_t slot) const;
  /// Transforms the pose and all points to the map; the rows of slots 0 and 1 are no longer valid.
  void put_in_map(JointEstimate& joint) const;

 private:
  Eigen::Matrix2d to_map() const;
  Eigen::Vector2d place_in_map(const Eigen::Vector2d& place) const;
  Eigen::Matrix<double, 2, 3> by_frame(const Eigen::Vector2d& place) const;

  Eigen::Vector2d start_;       ///< [m] start of the vehicle in the map
  Eigen::Vector2d origin_;      ///< [m] position of the point in slot 0
  Eigen::Vector2d axis_;        ///< unit vector from the point in slot 0 to the other one
  double heading_ = 0.0;        ///< [rad] heading of the axis
  Eigen::Matrix3d covariance_;  ///< covariance of origin and heading
};

}  // namespace montecarta::filters
