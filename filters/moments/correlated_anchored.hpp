// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/anchored_landmark.hpp"
#include "filters/moments/correlated_sight.hpp"

/// Anchored landmarks that are correlated with a pose that is not drawn (SPEC 24, last lines). The
/// anchor is a fixed place and direction, the mean pose at birth; what the pose erred by then is an
/// error of (range, bearing), correlated with that of the pose.
namespace montecarta {

template <class Real>
Symmetric2<Real> own_covariance(const AnchoredLandmark<Real>& landmark) {
  return {landmark.rr, landmark.rb, landmark.bb};
}
template <class Real>
void change(AnchoredLandmark<Real>& landmark, const BasicPoint<Real>& step,
            const Symmetric2<Real>& less) {
  landmark.mean.range += step.x;
  landmark.mean.bearing += step.y;
  landmark.rr -= less.xx, landmark.rb -= less.xy, landmark.bb -= less.yy;
}

/// g(a, q) and Gz P Gz'; covariances with q times Gz.
template <class Real>
struct AnchoredInMap {
  LinearisedPlace<Real> g;
  LandmarkGaussian<Real> gaussian;

  PoseCross<Real> rows(const PoseCross<Real>& C) const {
    return {{g.x_range * C.x.x + g.x_bearing * C.y.x, g.x_range * C.x.y + g.x_bearing * C.y.y,
             g.x_range * C.x.h + g.x_bearing * C.y.h},
            {g.y_range * C.x.x + g.y_bearing * C.y.x, g.y_range * C.x.y + g.y_bearing * C.y.y,
             g.y_range * C.x.h + g.y_bearing * C.y.h}};
  }
  MapCross<Real> columns(const MapCross<Real>& C) const {
    return {C.xx * g.x_range + C.xy * g.x_bearing, C.xx * g.y_range + C.xy * g.y_bearing,
            C.yx * g.x_range + C.yy * g.x_bearing, C.yx * g.y_range + C.yy * g.y_bearing};
  }
};
template <class Real>
AnchoredInMap<Real> in_map(const AnchoredLandmark<Real>& landmark) {
  const LinearisedPlace<Real> g = linearised_place(landmark.anchor, landmark.mean);
  return {g, as_gaussian(landmark, g)};
}

/// What the anchor sees of a new landmark, made straight by the errors of the pose and of the
/// bearing: range = mean + along + across.range across + turn.range turn, bearing likewise without
/// `along`, with noise; `turn` is the sum of the errors of heading and bearing.
template <class Real>
struct StraightBirth {
  RangeBearing<Real> mean;
  RangeBearing<Real> across;  ///< [1], [rad/m]
  RangeBearing<Real> turn;    ///< [m/rad], [1]
  Real n_rr, n_rb, n_bb;      ///< of the sensor's range, and of what is not straight
};

/// A landmark seen for the first time from an uncertain pose: linearised it is (range, bearing) as
/// seen, with R + J P J' and J P, J = Gz^-1 Gx = [u, 0; u' / range, 1] by the pose, u along the ray
/// and u' across it to the left.
template <class Real>
struct NewAnchoredLandmark {
  AnchoredLandmark<Real> landmark;
  PoseCross<Real> pose_cross;
  Column3<Real> by_range, by_bearing;  ///< J

  /// Its covariance with a number whose covariance with the pose is given.
  RangeBearing<Real> with(const Column3<Real>& pose) const {
    return {by_range.x * pose.x + by_range.y * pose.y + by_range.h * pose.h,
            by_bearing.x * pose.x + by_bearing.y * pose.y + by_bearing.h * pose.h};
  }
  /// Its covariance with another landmark, this one's rows.
  MapCross<Real> with(const PoseCross<Real>& other) const {
    const RangeBearing<Real> x = with(other.x), y = with(other.y);
    return {x.range, y.range, x.bearing, y.bearing};
  }
};

template <class Real, class Transform>
NewAnchoredLandmark<Real> new_correlated_anchored_landmark(const PoseGaussian<Real>& pose,
                                                           const RangeBearing<Real>& seen,
                                                           const SensorNoise& noise,
                                                           const Transform& transform) {
  const auto& [mean, P] = pose;
  const Direction<Real> ray = direction_of(Real(mean.heading + seen.bearing));
  const Real ux = ray.cosine, uy = ray.sine;
  const StraightBirth<Real> b =
      transform.straight_birth(turned(P, Direction<Real>{ux, -uy}), seen, noise);
  NewAnchoredLandmark<Real> born{{mean, b.mean},
                                 {},
                                 {ux - b.across.range * uy, uy + b.across.range * ux, b.turn.range},
                                 {-(b.across.bearing * uy), b.across.bearing * ux, b.turn.bearing}};
  const RangeBearing<Real> x = born.with(Column3<Real>{P.xx, P.xy, P.xh});
  const RangeBearing<Real> y = born.with(Column3<Real>{P.xy, P.yy, P.yh});
  const RangeBearing<Real> h = born.with(Column3<Real>{P.xh, P.yh, P.hh});
  born.pose_cross = {{x.range, y.range, h.range}, {x.bearing, y.bearing, h.bearing}};
  const MapCross<Real> own = born.with(born.pose_cross);
  born.landmark.rr = b.n_rr + b.turn.range * b.turn.range * noise.bearing + own.xx;
  born.landmark.rb = b.n_rb + b.turn.range * b.turn.bearing * noise.bearing + own.xy;
  born.landmark.bb = b.n_bb + b.turn.bearing * b.turn.bearing * noise.bearing + own.yy;
  return born;
}

}  // namespace montecarta
