// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/displacement.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace montecarta::filters {

/// The layout of the state of a joint Gaussian that knows places relative to each other only
/// (EQUATIONS 22). Frame 0 is the start; displacement k leads from frame k to frame k + 1, the last
/// one from the newest frame to the vehicle.
struct RelativeChain {
  /// A landmark in a frame.
  struct Point {
    Eigen::Index row;   ///< of its two coordinates
    std::size_t frame;  ///< that they are in
    bool is_polar;      ///< range and bearing [m, rad]; else x and y [m]
  };
  struct Landmark {
    Point first;                 ///< where it was initialised
    std::optional<Point> again;  ///< initialised a second time, not joined with the first yet
  };

  Pose start;                               ///< in the map frame, known
  std::vector<Eigen::Index> displacements;  ///< {frame} first of the rows x, y, heading [m, m, rad]
  std::vector<Landmark> landmarks;          ///< in the order of initialisation

  std::size_t newest_frame() const { return displacements.size() - 1; }
};

/// A displacement followed by another, with derivatives.
struct LinearisedComposition {
  Pose pose;
  Eigen::Matrix3d by_first, by_second;
};
LinearisedComposition linearised_composition(const Pose& first, const Pose& second);

/// A point in its frame [m], with its derivative by its two coordinates.
struct LinearisedPoint {
  Point place;
  Eigen::Matrix2d by_coordinates;
};
LinearisedPoint linearised_point(const RelativeChain::Point& point, const Eigen::VectorXd& mean);

/// Displacement k of the chain.
Pose displacement(const RelativeChain& chain, std::size_t k, const Eigen::VectorXd& mean);

}  // namespace montecarta::filters
