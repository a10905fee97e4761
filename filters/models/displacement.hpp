// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/ackermann.hpp"

namespace montecarta::models {

/// `pose` in the frame of `origin`.
inline Pose relative_to(const Pose& origin, const Pose& pose) {
  const Direction<double> d = direction_of(origin.heading);
  const double dx = pose.x - origin.x, dy = pose.y - origin.y;
  return {d.cosine * dx + d.sine * dy, d.cosine * dy - d.sine * dx,
          wrap(pose.heading - origin.heading)};
}

/// The pose whose displacement in the frame of `origin` is `displacement`.
inline Pose composed(const Pose& origin, const Pose& displacement) {
  const Point way = in_world(direction_of(origin.heading), displacement.x, displacement.y);
  return {origin.x + way.x, origin.y + way.y, wrap(origin.heading + displacement.heading)};
}

}  // namespace montecarta::models
