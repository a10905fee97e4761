// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"

#include <Eigen/Core>

#include <vector>

namespace montecarta::engine {

/// Mean and covariance of an estimate of the pose; covariance over (x, y, heading) [m, m, rad].
struct PoseMoments {
  Pose mean;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// One landmark in the report of a filter. It has the identity of the world with known association,
/// else the order of initialisation.
struct LandmarkEstimate {
  Eigen::Vector2d mean;        ///< [m]
  Eigen::Matrix2d covariance;  ///< [m^2]
};

/// The knowledge of a filter before the first step of a run. The errors of the pose and of all
/// landmarks are independent. A covariance of zero means exact knowledge.
struct Prior {
  PoseMoments pose;
  std::vector<LandmarkEstimate> map = {};  ///< {identity} known landmarks; empty: none is known
};

/// Standard deviations of what a filter knows before the first step; zero means exact.
struct PriorDeviations {
  double position = 0.0;  ///< [m] of the start, in x and in y
  double heading = 0.0;   ///< [rad] of the heading at the start
  double landmark = 0.0;  ///< [m] of a known landmark, in x and in y

  Eigen::Matrix3d start_covariance() const {
    return Eigen::Vector3d(position, position, heading).cwiseAbs2().asDiagonal();
  }
  Eigen::Matrix2d landmark_covariance() const {
    return landmark * landmark * Eigen::Matrix2d::Identity();
  }
};

}  // namespace montecarta::engine
