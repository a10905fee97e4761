// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "filters/moments/linearised.hpp"

/// Predicted detections of a sensor of any kind, linearised at the pose of the sensor (EQUATIONS
/// 2). A component that the sensor does not have has derivatives and innovation 0 and variance 1.
namespace montecarta::filters {

template <class Kind>
inline constexpr bool kHasTwoComponents = Kind::kComponents.size() == 2;

/// A landmark observed from the pose of the sensor.
template <class Kind, class Real>
struct SensorSight {
  Measurement<Real> predicted;  ///< angles not wrapped: only for residual()
  Column3<Real> first, second;  ///< rows of Hx; those by the landmark are the negatives of (x, y)
  Real distance;                ///< [m] distance from the sensor to the landmark
};

template <class Real>
[[gnu::always_inline]] inline LineOfSight<Real> sight(RangeBearingSensor,
                                                      const BasicPose<Real>& sensor,
                                                      const BasicPoint<Real>& landmark) {
  return line_of_sight(sensor, landmark);
}
template <class Real>
[[gnu::always_inline]] inline SensorSight<PositionSensor, Real> sight(
    PositionSensor, const BasicPose<Real>& sensor, const BasicPoint<Real>& landmark) {
  const Direction<Real> d = direction_of(sensor.heading);
  const Real dx = landmark.x - sensor.x, dy = landmark.y - sensor.y;
  const Real forward = d.cosine * dx + d.sine * dy, left = d.cosine * dy - d.sine * dx;
  return {{forward, left},
          {-d.cosine, -d.sine, left},
          {d.sine, -d.cosine, -forward},
          Real(1.0)};  // the derivatives exist at any distance
}
template <class Real>
[[gnu::always_inline]] inline SensorSight<BearingSensor, Real> sight(
    BearingSensor, const BasicPose<Real>& sensor, const BasicPoint<Real>& landmark) {
  const LineOfSight<Real> s = line_of_sight(sensor, landmark);
  return {{s.predicted.bearing, Real(0.0)},
          {s.uy * s.per_range, -s.ux * s.per_range, Real(-1.0)},
          {},
          s.predicted.range};
}
template <class Real>
[[gnu::always_inline]] inline SensorSight<RangeSensor, Real> sight(
    RangeSensor, const BasicPose<Real>& sensor, const BasicPoint<Real>& landmark) {
  const LineOfSight<Real> s = line_of_sight(sensor, landmark);
  return {{s.predicted.range, Real(0.0)}, {-s.ux, -s.uy, Real(0.0)}, {}, s.predicted.range};
}

template <class Kind, class Real>
[[gnu::always_inline]] inline auto is_usable(const SensorSight<Kind, Real>& s) {
  return s.distance > Real(kLeastDistance);
}

/// a - b, with an angle wrapped.
template <class Kind, class Real>
[[gnu::always_inline]] inline Measurement<Real> difference(Kind, const Measurement<Real>& a,
                                                           const Measurement<Real>& b) {
  const Real first = a.first - b.first;
  if constexpr (kHasTwoComponents<Kind>) {
    return {first, a.second - b.second};
  } else if constexpr (wraps(Kind::kComponents[0])) {
    return {shorter_way(first), Real(0.0)};
  } else {
    return {first, Real(0.0)};
  }
}
/// Innovation, detected minus predicted.
template <class Kind, class Real>
[[gnu::always_inline]] inline Measurement<Real> residual(const Measurement<Real>& detected,
                                                         const SensorSight<Kind, Real>& s) {
  return difference(Kind(), detected, s.predicted);
}

/// a' P b over (x, y).
template <class Real>
[[gnu::always_inline]] inline Real form(const Column3<Real>& a, const Symmetric2<Real>& P,
                                        const Column3<Real>& b) {
  return a.x * (P.xx * b.x + P.xy * b.y) + a.y * (P.xy * b.x + P.yy * b.y);
}
/// P times a row of derivatives by the pose.
template <class Real>
[[gnu::always_inline]] inline Column3<Real> times(const Symmetric3<Real>& P,
                                                  const Column3<Real>& row) {
  return {P.xx * row.x + P.xy * row.y + P.xh * row.h, P.xy * row.x + P.yy * row.y + P.yh * row.h,
          P.xh * row.x + P.yh * row.y + P.hh * row.h};
}
template <class Real>
[[gnu::always_inline]] inline Real dot(const Column3<Real>& a, const Column3<Real>& b) {
  return a.x * b.x + a.y * b.y + a.h * b.h;
}

/// The innovation of a detection for a Gaussian of the sensor's pose (EQUATIONS 6).
template <class Kind, class Real>
[[gnu::always_inline]] inline Innovation<Real> innovation_of(const Symmetric3<Real>& P,
                                                             const SensorSight<Kind, Real>& s,
                                                             const Measurement<Real>& value,
                                                             const Symmetric2<Real>& map,
                                                             const SensorNoise& noise) {
  const Column3<Real> first = times(P, s.first), second = times(P, s.second);
  return {value,
          {noise.first + form(s.first, map, s.first) + dot(s.first, first),
           form(s.first, map, s.second) + dot(s.first, second),
           noise.second + form(s.second, map, s.second) + dot(s.second, second)},
          first,
          second};
}

/// Adds a detection to the evidence. The density of a component that the sensor does not have must
/// be 1, which is that of 0 with the variance 1 / 2 pi.
template <class Kind, class Real, class Use, class Mask, class Weighed>
[[gnu::always_inline]] inline void weigh(Kind, const Density<Real>& density, const Use& use,
                                         const Mask& matched, Weighed& evidence) {
  const Real used = as_number<Real>(use);
  const Real determinant =
      kHasTwoComponents<Kind>
          ? density.determinant
          : select(use, Real(density.determinant * (1.0 / kTwoPi)), density.determinant);
  evidence.add(density.squared, determinant, used, as_number<Real>(matched));
}

/// Initialises a landmark from one detection at an exactly known pose of the sensor: g(x, z) and Gz
/// R Gz' (EQUATIONS 2, 4).
template <class Kind, class Real>
LandmarkGaussian<Real> placed_landmark(Kind, const BasicPose<Real>& sensor,
                                       const Measurement<Real>& seen, const SensorNoise& noise) {
  expect(FixesLandmark<Kind>, "one detection of this sensor places no landmark");
  const Direction<Real> d = direction_of(sensor.heading);
  const LineOfSight<Real> axes{{}, d.cosine, d.sine, Real(1.0)};
  const Turned<Real> R{Real(noise.first), Real(0.0), Real(noise.second)};
  return {BasicPoint<Real>{sensor.x, sensor.y} + in_map(seen.first, seen.second, axes),
          turned_back(R, axes)};
}

/// Kalman update of a landmark observed from an exactly known pose; the columns of the innovation
/// `v` are those of the landmark.
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

/// `Linearised` for a sensor of another kind; poses are those of the sensor.
template <class Kind>
struct LinearisedSensor : Linearised {
  template <class Real, class Mask>
  [[gnu::always_inline]] Innovation<Real> refine(PoseGaussian<Real>& pose,
                                                 const LandmarkGaussian<Real>& landmark,
                                                 const Measurement<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Evidence<Real>& evidence) const {
    const auto s = sight(Kind(), pose.mean, landmark.mean);
    return refine(pose, s, residual(seen, s), landmark, noise, matched, evidence);
  }
  template <class Real, class Mask>
  void refine_in_batch(PoseGaussian<Real>& pose, const BasicPose<Real>& predicted,
                       const LandmarkGaussian<Real>& landmark, const Measurement<Real>& seen,
                       const SensorNoise& noise, const Mask& matched,
                       Evidence<Real>& evidence) const {
    const auto s = sight(Kind(), predicted, landmark.mean);
    const Column3<Real> moved{pose.mean.x - predicted.x, pose.mean.y - predicted.y,
                              shorter_way(Real(pose.mean.heading - predicted.heading))};
    Measurement<Real> value = residual(seen, s);
    value.first -= dot(s.first, moved);
    value.second -= dot(s.second, moved);
    refine(pose, s, value, landmark, noise, matched, evidence);
  }
  template <class Real, class Mask, class Weighed>
  [[gnu::always_inline]] Innovation<Real> update(LandmarkGaussian<Real>& landmark,
                                                 const BasicPose<Real>& pose,
                                                 const Measurement<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Weighed& evidence) const {
    const auto s = sight(Kind(), pose, landmark.mean);
    const Symmetric2<Real>& M = landmark.covariance;
    Innovation<Real> v = innovation_of(Symmetric3<Real>{}, s, residual(seen, s), M, noise);
    const auto column = [&M](const Column3<Real>& row) {
      return Column3<Real>{-(M.xx * row.x + M.xy * row.y), -(M.xy * row.x + M.yy * row.y),
                           Real(0.0)};
    };
    v.first = column(s.first), v.second = column(s.second);
    const auto use = matched && is_usable(s);
    weigh(Kind(), condition(landmark, v, use), use, matched, evidence);
    return v;
  }
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const Measurement<Real>& seen,
                                    const SensorNoise& noise) const {
    return placed_landmark(Kind(), pose, seen, noise);
  }

 private:
  template <class Real, class Mask>
  [[gnu::always_inline]] static Innovation<Real> refine(
      PoseGaussian<Real>& pose, const SensorSight<Kind, Real>& s, const Measurement<Real>& value,
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

/// Converts a transform for range and bearing to that for a sensor of another kind.
template <class Kind>
LinearisedSensor<Kind> of_kind(Kind, const Linearised& /*transform*/) {
  return {};
}

}  // namespace montecarta::filters
