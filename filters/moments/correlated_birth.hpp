// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/correlated_map.hpp"
#include "filters/moments/sensor_noise.hpp"

namespace montecarta {

/// A landmark seen for the first time from an uncertain pose, with all it is correlated with:
/// g(x, z), Gx P Gx' + Gz R Gz' and Gx P (EQUATIONS 15).
template <class Real>
struct NewLandmark {
  LandmarkGaussian<Real> landmark;
  PoseCross<Real> pose_cross;
  BasicPoint<Real> lever;  ///< what an error of the heading adds to it [m/rad]

  /// Its covariance with another landmark, this one's rows.
  MapCross<Real> with(const PoseCross<Real>& other) const {
    return {other.x.x + lever.x * other.x.h, other.y.x + lever.x * other.y.h,
            other.x.y + lever.y * other.x.h, other.y.y + lever.y * other.y.h};
  }
};

template <class Real>
NewLandmark<Real> new_correlated_landmark(const PoseGaussian<Real>& pose,
                                          const RangeBearing<Real>& seen,
                                          const SensorNoise& noise) {
  const auto& [mean, P] = pose;
  const Direction<Real> ray = direction_of(Real(mean.heading + seen.bearing));
  const Real a = -(seen.range * ray.sine), b = seen.range * ray.cosine;
  const PoseCross<Real> C{{P.xx + a * P.xh, P.xy + a * P.yh, P.xh + a * P.hh},
                          {P.xy + b * P.xh, P.yy + b * P.yh, P.yh + b * P.hh}};
  const Real across = noise.bearing, along = noise.range;
  return {{{mean.x + seen.range * ray.cosine, mean.y + seen.range * ray.sine},
           {C.x.x + a * C.x.h + a * a * across + ray.cosine * ray.cosine * along,
            C.x.y + b * C.x.h + a * b * across + ray.cosine * ray.sine * along,
            C.y.y + b * C.y.h + b * b * across + ray.sine * ray.sine * along}},
          C,
          {a, b}};
}

/// Makes landmark i of block b the new one; `put(from, to)` writes the lanes that are meant.
template <class Real, class Put>
void place(CorrelatedMap<Real>& maps, std::size_t b, std::size_t i, const NewLandmark<Real>& born,
           const Put& put) {
  for (std::size_t j = 0; j < maps.size(); ++j) {
    if (j == i) continue;
    const MapCross<Real> c = born.with(maps.pose_cross(j, b));
    if (j < i) {
      put(c, maps.map_cross(i, j, b));
    } else {
      put(MapCross<Real>{c.xx, c.yx, c.xy, c.yy}, maps.map_cross(j, i, b));
    }
  }
  put(born.landmark, maps.landmark(i, b));
  put(born.pose_cross, maps.pose_cross(i, b));
}

}  // namespace montecarta
