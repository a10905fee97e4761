// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/moments/gaussians.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::filters {

/// Solves A v = b for a symmetric positive definite A.
inline Point solve(const Symmetric2<double>& A, const Point& b) {
  const double slope = A.xy / A.xx;
  const double y = (b.y - slope * b.x) / (A.yy - slope * A.xy);
  return {(b.x - A.xy * y) / A.xx, y};
}

/// A landmark of the one map that all particles share (EQUATIONS 14): where it is, and how well
/// that is known if the pose were.
struct SharedLandmark {
  Point mean;
  Symmetric2<double> information;  ///< Lambda [1/m^2]

  /// Lambda^-1.
  Symmetric2<double> covariance() const {
    const Point x = solve(information, {1.0, 0.0}), y = solve(information, {0.0, 1.0});
    return {x.x, x.y, y.y};
  }
};

/// All landmarks, in the order of initialisation.
using SharedMap = std::vector<SharedLandmark>;

/// As the engine stores it.
inline LandmarkEstimate estimate_of(const SharedLandmark& landmark) {
  const Symmetric2<double> P = landmark.covariance();
  return {{landmark.mean.x, landmark.mean.y}, Eigen::Matrix2d{{P.xx, P.xy}, {P.xy, P.yy}}};
}

}  // namespace montecarta::filters
