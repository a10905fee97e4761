// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/linearised.hpp"

namespace montecarta {

/// What one particle believes about a landmark, as range and bearing from the pose it was first
/// seen from (SPEC 24, last lines): there a sight is a Gaussian, while in the map it is bent like a
/// banana.
template <class Real>
struct AnchoredLandmark {
  BasicPose<Real> anchor{};   ///< exact: the particle's pose at birth, its mean where undrawn
  RangeBearing<Real> mean{};  ///< q = (range, bearing) seen from it; the bearing is not wrapped
  Real rr{}, rb{}, bb{};      ///< covariance of q
};

/// The Gaussian in the map that an anchored landmark is nearly, linearised at q: g(a, q), Gz P Gz'.
template <class Real>
LandmarkGaussian<Real> as_gaussian(const AnchoredLandmark<Real>& landmark,
                                   const LinearisedPlace<Real>& g) {
  const Real x_r = g.x_range * landmark.rr + g.x_bearing * landmark.rb;
  const Real x_b = g.x_range * landmark.rb + g.x_bearing * landmark.bb;
  const Real y_r = g.y_range * landmark.rr + g.y_bearing * landmark.rb;
  const Real y_b = g.y_range * landmark.rb + g.y_bearing * landmark.bb;
  return {g.point,
          {x_r * g.x_range + x_b * g.x_bearing, x_r * g.y_range + x_b * g.y_bearing,
           y_r * g.y_range + y_b * g.y_bearing}};
}
template <class Real>
LandmarkGaussian<Real> as_gaussian(const AnchoredLandmark<Real>& landmark) {
  return as_gaussian(landmark, linearised_place(landmark.anchor, landmark.mean));
}
/// One that is a Gaussian in the map already.
template <class Real>
[[gnu::always_inline]] inline const LandmarkGaussian<Real>& as_gaussian(
    const LandmarkGaussian<Real>& landmark) {
  return landmark;
}

/// The sight of an anchored landmark from an exactly known pose, linearised at q: Hf Gz. The lines
/// of sight from pose and anchor meet at an angle of which only sine and cosine matter.
template <class Real>
struct AnchoredSight {
  Sightline<Real> s;
  Real range_range, range_bearing, bearing_range, bearing_bearing;  ///< Hf Gz

  [[gnu::always_inline]] AnchoredSight(const BasicPose<Real>& pose, const BasicPose<Real>& anchor,
                                       const RangeBearing<Real>& q) {
    const Direction<Real> ray = direction_of(Real(anchor.heading + q.bearing));
    s = sightline(pose,
                  BasicPoint<Real>{anchor.x + q.range * ray.cosine, anchor.y + q.range * ray.sine});
    range_range = s.ux * ray.cosine + s.uy * ray.sine;
    const Real across = s.uy * ray.cosine - s.ux * ray.sine;
    range_bearing = q.range * across;
    bearing_range = -(across * s.per_range);
    bearing_bearing = q.range * range_range * s.per_range;
  }
};

/// Gain of q by a sight.
template <class Real>
struct AnchoredGain {
  Real range_range, range_bearing, bearing_range, bearing_bearing;
};

/// H P H' + R and P H' of an anchored landmark.
template <class Real>
struct AnchoredInnovation {
  Real s_rr, s_rb, s_bb;
  Real r_r, r_b, b_r, b_b;  ///< covariance of q's range and bearing with those that are seen

  [[gnu::always_inline]] AnchoredInnovation(const AnchoredLandmark<Real>& q,
                                            const AnchoredSight<Real>& H,
                                            const SensorNoise& noise) {
    r_r = q.rr * H.range_range + q.rb * H.range_bearing;
    r_b = q.rr * H.bearing_range + q.rb * H.bearing_bearing;
    b_r = q.rb * H.range_range + q.bb * H.range_bearing;
    b_b = q.rb * H.bearing_range + q.bb * H.bearing_bearing;
    s_rr = noise.range + H.range_range * r_r + H.range_bearing * b_r;
    s_rb = H.range_range * r_b + H.range_bearing * b_b;
    s_bb = noise.bearing + H.bearing_range * r_b + H.bearing_bearing * b_b;
  }
  [[gnu::always_inline]] Real determinant() const { return s_rr * s_bb - s_rb * s_rb; }
  /// P H' S^-1; `inverse` = 1 / det S, or 0 where nothing is to be absorbed.
  [[gnu::always_inline]] AnchoredGain<Real> gain(const Real& inverse) const {
    return {(r_r * s_bb - r_b * s_rb) * inverse, (r_b * s_rr - r_r * s_rb) * inverse,
            (b_r * s_bb - b_b * s_rb) * inverse, (b_b * s_rr - b_r * s_rb) * inverse};
  }
};

/// (I - K H) P (I - K H)' + K R K': a sum of squares, nothing to turn negative (SPEC 7.3).
template <class Real>
[[gnu::always_inline]] inline void set_covariance_after(AnchoredLandmark<Real>& q,
                                                        const AnchoredSight<Real>& H,
                                                        const AnchoredGain<Real>& K,
                                                        const SensorNoise& noise) {
  const Real a = 1.0 - K.range_range * H.range_range - K.range_bearing * H.bearing_range;
  const Real b = -(K.range_range * H.range_bearing + K.range_bearing * H.bearing_bearing);
  const Real c = -(K.bearing_range * H.range_range + K.bearing_bearing * H.bearing_range);
  const Real d = 1.0 - K.bearing_range * H.range_bearing - K.bearing_bearing * H.bearing_bearing;
  const Real top_r = a * q.rr + b * q.rb, top_b = a * q.rb + b * q.bb;
  const Real low_r = c * q.rr + d * q.rb, low_b = c * q.rb + d * q.bb;
  q.rr = top_r * a + top_b * b + K.range_range * K.range_range * noise.range +
         K.range_bearing * K.range_bearing * noise.bearing;
  q.rb = top_r * c + top_b * d + K.range_range * K.bearing_range * noise.range +
         K.range_bearing * K.bearing_bearing * noise.bearing;
  q.bb = low_r * c + low_b * d + K.bearing_range * K.bearing_range * noise.range +
         K.bearing_bearing * K.bearing_bearing * noise.bearing;
}

/// Absorbs one detection into a landmark seen from an exactly known pose: the most probable q by
/// three steps of Gauss and Newton, each from the belief before the detection. Weighed by the
/// first.
template <class Real, class Mask, class Weighed>
[[gnu::always_inline]] inline Innovation<Real> update_anchored(
    AnchoredLandmark<Real>& landmark, const BasicPose<Real>& pose, const RangeBearing<Real>& seen,
    const SensorNoise& noise, const Mask& matched, Weighed& evidence) {
  constexpr int kSteps = 3;
  const RangeBearing<Real> before = landmark.mean;
  AnchoredSight<Real> H(pose, landmark.anchor, before);
  AnchoredInnovation<Real> S(landmark, H, noise);
  const auto use = matched && is_usable(H.s);
  const Innovation<Real> first{residual(seen, H.s), S.s_rr, S.s_rb, S.s_bb, {}, {}};
  const Real determinant = S.determinant();
  evidence.add(select(use, first.squared(), Real(0.0)), select(use, determinant, Real(1.0)),
               as_number<Real>(use), as_number<Real>(matched));
  RangeBearing<Real> value = first.value;
  AnchoredGain<Real> K = S.gain(select(use, 1.0 / determinant, Real(0.0)));
  for (int step = 1;; ++step) {
    landmark.mean = {
        before.range + K.range_range * value.range + K.range_bearing * value.bearing,
        before.bearing + K.bearing_range * value.range + K.bearing_bearing * value.bearing};
    if (step == kSteps) break;
    H = AnchoredSight<Real>(pose, landmark.anchor, landmark.mean);
    S = AnchoredInnovation<Real>(landmark, H, noise);
    const Real r = landmark.mean.range - before.range, b = landmark.mean.bearing - before.bearing;
    value = residual(seen, H.s);
    value.range += H.range_range * r + H.range_bearing * b;
    value.bearing += H.bearing_range * r + H.bearing_bearing * b;
    K = S.gain(select(use, 1.0 / S.determinant(), Real(0.0)));
  }
  set_covariance_after(landmark, H, K, noise);
  return first;
}

/// A landmark seen for the first time from an exactly known pose: the detection as it stands.
template <class Real>
AnchoredLandmark<Real> new_anchored_landmark(const BasicPose<Real>& pose,
                                             const RangeBearing<Real>& seen,
                                             const SensorNoise& noise) {
  return {pose, seen, Real(noise.range), Real(0.0), Real(noise.bearing)};
}

}  // namespace montecarta
