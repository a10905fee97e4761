// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <span>

namespace montecarta::analysis {

/// A turn of the plane and then a shift: neither stretches nor mirrors.
struct RigidMotion {
  double angle = 0.0;                               ///< [rad] counter-clockwise
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< [m]

  Eigen::Vector2d operator()(const Eigen::Vector2d& point) const;
};

/// The rigid motion that brings the points `from` [m] nearest to the points `onto` [m], pair by
/// pair, in the sum of squared distances: in the plane in closed form (Umeyama 1991 without scale).
/// One point is only shifted, none stays where it is.
RigidMotion rigid_alignment(std::span<const Eigen::Vector2d> from,
                            std::span<const Eigen::Vector2d> onto);

}  // namespace montecarta::analysis
