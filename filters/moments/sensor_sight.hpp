// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/sensor_kinds.hpp"
#include "filters/moments/linearised.hpp"

/// What a sensor of any kind sees of a landmark, linearised at its own pose (EQUATIONS 2). The
/// components of a detection, in their order, are what RangeBearing, SensorNoise and Innovation
/// name range and bearing; one that the sensor does not have has derivatives and innovation of 0
/// and variance 1.
namespace montecarta::filters {

template <class Kind>
inline constexpr bool kHasTwoComponents = Kind::kComponents.size() == 2;

/// A landmark seen from the pose of the sensor.
template <class Kind, class Real>
struct SensorSight {
  RangeBearing<Real> predicted;  ///< angles not wrapped: for residual() only
  Column3<Real> first, second;   ///< rows by the pose; by the landmark the negatives of (x, y)
  Real distance;                 ///< [m]
};

/// The components that a sensor sees of a place in its own frame.
template <class Real>
[[gnu::always_inline]] inline RangeBearing<Real> observed(PositionSensor, const Real& forward,
                                                          const Real& left) {
  return {forward, left};
}
template <class Real>
[[gnu::always_inline]] inline RangeBearing<Real> observed(BearingSensor, const Real& forward,
                                                          const Real& left) {
  return {atan2(left, forward), Real(0.0)};
}
template <class Real>
[[gnu::always_inline]] inline RangeBearing<Real> observed(RangeSensor, const Real& forward,
                                                          const Real& left) {
  return {length(forward, left), Real(0.0)};
}

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
          Real(1.0)};  // near or far, there are derivatives
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

/// a - b, an angle by the shorter way.
template <class Kind, class Real>
[[gnu::always_inline]] inline RangeBearing<Real> difference(Kind, const RangeBearing<Real>& a,
                                                            const RangeBearing<Real>& b) {
  const Real first = a.range - b.range;
  if constexpr (kHasTwoComponents<Kind>) {
    return {first, a.bearing - b.bearing};
  } else if constexpr (name_of(Kind::kComponents[0]).wraps) {
    return {shorter_way(first), Real(0.0)};
  } else {
    return {first, Real(0.0)};
  }
}
/// detected boxminus predicted.
template <class Kind, class Real>
[[gnu::always_inline]] inline RangeBearing<Real> residual(const RangeBearing<Real>& detected,
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

/// What a detection says of a Gaussian of the sensor's pose (EQUATIONS 6).
template <class Kind, class Real>
[[gnu::always_inline]] inline Innovation<Real> innovation_of(const Symmetric3<Real>& P,
                                                             const SensorSight<Kind, Real>& s,
                                                             const RangeBearing<Real>& value,
                                                             const Symmetric2<Real>& map,
                                                             const SensorNoise& noise) {
  const Column3<Real> first = times(P, s.first), second = times(P, s.second);
  return {value,
          {noise.range + form(s.first, map, s.first) + dot(s.first, first),
           form(s.first, map, s.second) + dot(s.first, second),
           noise.bearing + form(s.second, map, s.second) + dot(s.second, second)},
          first,
          second};
}

/// Adds what a detection weighs by. The density of a component that does not exist is 1: that of
/// 0 with variance 1 / 2 pi.
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

}  // namespace montecarta::filters
