// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"

#include <Eigen/Core>

namespace montecarta::engine {

/// Vehicle pose in the map frame; `Real` is double or Lanes.
template <class Real>
struct BasicPose {
  Real x{};        ///< [m]
  Real y{};        ///< [m]
  Real heading{};  ///< [rad], in (-pi, pi]
};
using Pose = BasicPose<double>;

/// Position of a pose [m].
inline Eigen::Vector2d place_of(const Pose& pose) { return {pose.x, pose.y}; }

/// The error of a relative to b: (x [m], y [m], heading [rad], wrapped) that moves b onto a.
inline Eigen::Vector3d boxminus(const Pose& a, const Pose& b) {
  return {a.x - b.x, a.y - b.y, wrap(a.heading - b.heading)};
}

}  // namespace montecarta::engine
