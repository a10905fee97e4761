// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/correlated_map.hpp"
#include "filters/moments/motion_increment.hpp"

namespace montecarta {

/// A pose that is itself uncertain, driven on, and what its heading did to its place: x and y
/// change by `lever` times an error of the heading.
template <class Real>
struct DrivenPose {
  PoseGaussian<Real> pose;
  BasicPoint<Real> lever;  ///< [m/rad]
};

/// Fx P Fx' with the motion's own covariance turned into the map (EQUATIONS 1). Of several steps Fx
/// is again [1 0 a; 0 1 b; 0 0 1], so one increment stands for all since the last scan.
template <class Real>
DrivenPose<Real> driven(const PoseGaussian<Real>& before, const MotionIncrement& motion) {
  const auto& [mean, P] = before;
  const Direction<Real> d = direction_of(mean.heading);
  const Pose& step = motion.pose();
  const Real way_x = d.cosine * step.x - d.sine * step.y;
  const Real way_y = d.sine * step.x + d.cosine * step.y;
  return {{{mean.x + way_x, mean.y + way_y, wrap(Real(mean.heading + step.heading))},
           sheared(P, Real(-way_y), way_x) + turned(in_every_lane<Real>(motion.covariance()), d)},
          {-way_y, way_x}};
}

/// Drives block b on, map included.
template <class Real>
void drive(CorrelatedMap<Real>& maps, std::size_t b, const MotionIncrement& motion) {
  const DrivenPose<Real> now = driven(maps.pose(b), motion);
  maps.pose(b) = now.pose;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    auto& [x, y] = maps.pose_cross(i, b);
    x.x += now.lever.x * x.h;
    x.y += now.lever.y * x.h;
    y.x += now.lever.x * y.h;
    y.y += now.lever.y * y.h;
  }
}

}  // namespace montecarta
