// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/moment_transforms.hpp"

/// The extended Kalman filter of a sensor that measures positions (EQUATIONS (2.4)). What is named
/// range and bearing in a detection, its noise and its innovation is here forward and left [m].
namespace montecarta::filters {

/// A landmark seen from a pose, in the frame of the vehicle.
template <class Real>
struct PositionSight {
  RangeBearing<Real> predicted;  ///< forward, left [m]
  Direction<Real> heading;
};

template <class Real>
[[gnu::always_inline]] inline PositionSight<Real> position_sight(const BasicPose<Real>& pose,
                                                                 const BasicPoint<Real>& landmark) {
  const Direction<Real> heading = direction_of(pose.heading);
  const Real dx = landmark.x - pose.x, dy = landmark.y - pose.y;
  return {{heading.cosine * dx + heading.sine * dy, heading.cosine * dy - heading.sine * dx},
          heading};
}

/// detected less predicted.
template <class Real>
[[gnu::always_inline]] inline RangeBearing<Real> residual(const RangeBearing<Real>& detected,
                                                          const PositionSight<Real>& s) {
  return {detected.range - s.predicted.range, detected.bearing - s.predicted.bearing};
}

/// What a detection says of a pose Gaussian, with Hx = [-R' (left, -forward)'], R the turn by the
/// heading.
template <class Real>
[[gnu::always_inline]] inline Innovation<Real> innovation_of(const Symmetric3<Real>& P,
                                                             const PositionSight<Real>& s,
                                                             const RangeBearing<Real>& value,
                                                             const Symmetric2<Real>& map_covariance,
                                                             const SensorNoise& noise) {
  const Real c = s.heading.cosine, n = s.heading.sine;
  const Real &forward = s.predicted.range, &left = s.predicted.bearing;
  const auto times = [&P](const Real& x, const Real& y, const Real& h) {
    return Column3<Real>{P.xx * x + P.xy * y + P.xh * h, P.xy * x + P.yy * y + P.yh * h,
                         P.xh * x + P.yh * y + P.hh * h};
  };
  const Column3<Real> by_forward = times(-c, -n, left), by_left = times(n, -c, -forward);
  const Turned<Real> map = turned(map_covariance, LineOfSight<Real>{{}, c, n, Real(1.0)});
  return {value,
          {noise.range + map.along - c * by_forward.x - n * by_forward.y + left * by_forward.h,
           map.cross - c * by_left.x - n * by_left.y + left * by_left.h,
           noise.bearing + map.across + n * by_left.x - c * by_left.y - forward * by_left.h},
          by_forward,
          by_left};
}

/// Every detection of a position is usable.
template <class Real, class Mask>
[[gnu::always_inline]] inline auto usable(const Mask& matched) {
  return matched && (Real(0.0) < Real(1.0));
}

/// As `Linearised`.
struct LinearisedPosition : Linearised {
  template <class Real, class Mask>
  [[gnu::always_inline]] Innovation<Real> refine(PoseGaussian<Real>& pose,
                                                 const LandmarkGaussian<Real>& landmark,
                                                 const RangeBearing<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Evidence<Real>& evidence) const {
    const PositionSight<Real> s = position_sight(pose.mean, landmark.mean);
    return update(pose, s, residual(seen, s), landmark, noise, matched, evidence);
  }
  template <class Real, class Mask>
  void refine_in_batch(PoseGaussian<Real>& pose, const BasicPose<Real>& predicted,
                       const LandmarkGaussian<Real>& landmark, const RangeBearing<Real>& seen,
                       const SensorNoise& noise, const Mask& matched,
                       Evidence<Real>& evidence) const {
    const PositionSight<Real> s = position_sight(predicted, landmark.mean);
    const Real c = s.heading.cosine, n = s.heading.sine;
    const Real x = pose.mean.x - predicted.x, y = pose.mean.y - predicted.y;
    const Real h = pose.mean.heading - predicted.heading;
    RangeBearing<Real> value = residual(seen, s);
    value.range += c * x + n * y - s.predicted.bearing * h;
    value.bearing += c * y - n * x + s.predicted.range * h;
    update(pose, s, value, landmark, noise, matched, evidence);
  }
  /// A landmark of a known pose, updated as a pose is that has no heading.
  template <class Real, class Mask, class Weighed>
  [[gnu::always_inline]] Innovation<Real> update(LandmarkGaussian<Real>& landmark,
                                                 const BasicPose<Real>& pose,
                                                 const RangeBearing<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Weighed& evidence) const {
    const PositionSight<Real> s = position_sight(pose, landmark.mean);
    const Real c = s.heading.cosine, n = s.heading.sine;
    const Symmetric2<Real>& M = landmark.covariance;
    PoseGaussian<Real> place{{landmark.mean.x, landmark.mean.y, Real(0.0)},
                             {M.xx, M.xy, M.yy, Real(0.0), Real(0.0), Real(0.0)}};
    Innovation<Real> v = innovation_of(Symmetric3<Real>{}, s, residual(seen, s), M, noise);
    v.range = {c * M.xx + n * M.xy, c * M.xy + n * M.yy, Real(0.0)};
    v.bearing = {c * M.xy - n * M.xx, c * M.yy - n * M.xy, Real(0.0)};
    weigh(condition(place, v, usable<Real>(matched)), matched, evidence);
    landmark = {{place.mean.x, place.mean.y},
                {place.covariance.xx, place.covariance.xy, place.covariance.yy}};
    return v;
  }
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const RangeBearing<Real>& seen,
                                    const SensorNoise& noise) const {
    const Direction<Real> d = direction_of(pose.heading);
    const LineOfSight<Real> axes{{}, d.cosine, d.sine, Real(1.0)};
    const Turned<Real> R{Real(noise.range), Real(0.0), Real(noise.bearing)};
    return {BasicPoint<Real>{pose.x, pose.y} + in_map(seen.range, seen.bearing, axes),
            turned_back(R, axes)};
  }

 private:
  template <class Real, class Mask, class Weighed>
  [[gnu::always_inline]] static void weigh(const Density<Real>& density, const Mask& matched,
                                           Weighed& evidence) {
    const Real used = as_number<Real>(matched);
    evidence.add(density.squared, density.determinant, used, used);
  }
  template <class Real, class Mask>
  [[gnu::always_inline]] static Innovation<Real> update(
      PoseGaussian<Real>& pose, const PositionSight<Real>& s, const RangeBearing<Real>& value,
      const LandmarkGaussian<Real>& landmark, const SensorNoise& noise, const Mask& matched,
      Evidence<Real>& evidence) {
    Innovation<Real> v = innovation_of(pose.covariance, s, value, landmark.covariance, noise);
    weigh(condition(pose, v, usable<Real>(matched)), matched, evidence);
    return v;
  }
};

}  // namespace montecarta::filters
