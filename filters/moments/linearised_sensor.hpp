// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "filters/moments/moment_transforms.hpp"
#include "filters/moments/sensor_sight.hpp"

namespace montecarta::filters {

/// A landmark that one detection from an exactly known pose of the sensor places: g(x, z) and Gz R
/// Gz' (EQUATIONS 2, 4).
template <class Kind, class Real>
LandmarkGaussian<Real> placed_landmark(Kind, const BasicPose<Real>& sensor,
                                       const RangeBearing<Real>& seen, const SensorNoise& noise) {
  expect(FixesLandmark<Kind>, "one detection of this sensor places no landmark");
  const Direction<Real> d = direction_of(sensor.heading);
  const LineOfSight<Real> axes{{}, d.cosine, d.sine, Real(1.0)};
  const Turned<Real> R{Real(noise.range), Real(0.0), Real(noise.bearing)};
  return {BasicPoint<Real>{sensor.x, sensor.y} + in_map(seen.range, seen.bearing, axes),
          turned_back(R, axes)};
}

/// Kalman update of a landmark seen from an exactly known pose, by the innovation `v` whose columns
/// are those of the landmark.
template <class Real, class Mask>
[[gnu::always_inline]] inline Density<Real> condition(LandmarkGaussian<Real>& landmark,
                                                      const Innovation<Real>& v, const Mask& use) {
  const Symmetric2<Real>& M = landmark.covariance;
  PoseGaussian<Real> place{{landmark.mean.x, landmark.mean.y, Real(0.0)},
                           {M.xx, M.xy, M.yy, Real(0.0), Real(0.0), Real(0.0)}};
  Density<Real> density = condition(place, v, use);
  landmark = {{place.mean.x, place.mean.y},
              {place.covariance.xx, place.covariance.xy, place.covariance.yy}};
  return density;
}

/// As `Linearised`, of a sensor of another kind; poses are those of the sensor.
template <class Kind>
struct LinearisedSensor : Linearised {
  template <class Real, class Mask>
  [[gnu::always_inline]] Innovation<Real> refine(PoseGaussian<Real>& pose,
                                                 const LandmarkGaussian<Real>& landmark,
                                                 const RangeBearing<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Evidence<Real>& evidence) const {
    const auto s = sight(Kind(), pose.mean, landmark.mean);
    return refine(pose, s, residual(seen, s), landmark, noise, matched, evidence);
  }
  template <class Real, class Mask>
  void refine_in_batch(PoseGaussian<Real>& pose, const BasicPose<Real>& predicted,
                       const LandmarkGaussian<Real>& landmark, const RangeBearing<Real>& seen,
                       const SensorNoise& noise, const Mask& matched,
                       Evidence<Real>& evidence) const {
    const auto s = sight(Kind(), predicted, landmark.mean);
    const Column3<Real> moved{pose.mean.x - predicted.x, pose.mean.y - predicted.y,
                              shorter_way(Real(pose.mean.heading - predicted.heading))};
    RangeBearing<Real> value = residual(seen, s);
    value.range -= dot(s.first, moved);
    value.bearing -= dot(s.second, moved);
    refine(pose, s, value, landmark, noise, matched, evidence);
  }
  template <class Real, class Mask, class Weighed>
  [[gnu::always_inline]] Innovation<Real> update(LandmarkGaussian<Real>& landmark,
                                                 const BasicPose<Real>& pose,
                                                 const RangeBearing<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Weighed& evidence) const {
    const auto s = sight(Kind(), pose, landmark.mean);
    const Symmetric2<Real>& M = landmark.covariance;
    Innovation<Real> v = innovation_of(Symmetric3<Real>{}, s, residual(seen, s), M, noise);
    const auto column = [&M](const Column3<Real>& row) {
      return Column3<Real>{-(M.xx * row.x + M.xy * row.y), -(M.xy * row.x + M.yy * row.y),
                           Real(0.0)};
    };
    v.range = column(s.first), v.bearing = column(s.second);
    const auto use = matched && is_usable(s);
    weigh(Kind(), condition(landmark, v, use), use, matched, evidence);
    return v;
  }
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const RangeBearing<Real>& seen,
                                    const SensorNoise& noise) const {
    return placed_landmark(Kind(), pose, seen, noise);
  }

 private:
  template <class Real, class Mask>
  [[gnu::always_inline]] static Innovation<Real> refine(
      PoseGaussian<Real>& pose, const SensorSight<Kind, Real>& s, const RangeBearing<Real>& value,
      const LandmarkGaussian<Real>& landmark, const SensorNoise& noise, const Mask& matched,
      Evidence<Real>& evidence) {
    Innovation<Real> v = innovation_of(pose.covariance, s, value, landmark.covariance, noise);
    const auto use = matched && is_usable(s);
    weigh(Kind(), condition(pose, v, use), use, matched, evidence);
    return v;
  }
};
template <>
struct LinearisedSensor<RangeBearingSensor> : Linearised {};

}  // namespace montecarta::filters
