// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/evidence.hpp"
#include "filters/moments/motion_increment.hpp"

namespace montecarta::filters {

/// A landmark observed from a pose, in the frame with the axes along and across the line of sight.
template <class Real>
struct LineOfSight {
  RangeBearing<Real> predicted;  ///< bearing not wrapped: for residual() only
  Real ux, uy;                   ///< unit vector towards the landmark
  Real per_range;                ///< 1 / range [1/m]
};

template <class Real>
[[gnu::always_inline]] inline LineOfSight<Real> line_of_sight(const BasicPose<Real>& pose,
                                                              const BasicPoint<Real>& landmark) {
  const Real dx = landmark.x - pose.x;
  const Real dy = landmark.y - pose.y;
  const Real range = max(length(dx, dy), Real(kLeastDistance));
  const Real per_range = 1.0 / range;
  return {{range, atan2(dy, dx) - pose.heading}, dx * per_range, dy * per_range, per_range};
}

/// Innovation, detected minus predicted, with the bearing wrapped.
template <class Real>
[[gnu::always_inline]] inline Measurement<Real> residual(const Measurement<Real>& detected,
                                                         const LineOfSight<Real>& s) {
  return {detected.first - s.predicted.range,
          shorter_way(Real(detected.second - s.predicted.bearing))};
}

/// The covariance of a landmark [m^2], rotated into the frame of the line of sight.
template <class Real>
struct Turned {
  Real along, cross, across;
};

template <class Real>
[[gnu::always_inline]] inline Turned<Real> turned(const Symmetric2<Real>& P,
                                                  const LineOfSight<Real>& s) {
  const Real along_x = P.xx * s.ux + P.xy * s.uy;
  const Real along_y = P.xy * s.ux + P.yy * s.uy;
  const Real across_x = P.xy * s.ux - P.xx * s.uy;
  const Real across_y = P.yy * s.ux - P.xy * s.uy;
  return {along_x * s.ux + along_y * s.uy, along_y * s.ux - along_x * s.uy,
          across_y * s.ux - across_x * s.uy};
}

/// The mask of all lanes, for a landmark that all particles match.
struct AllLanes {};
template <class Mask>
[[gnu::always_inline]] inline Mask operator&&(AllLanes, const Mask& mask) {
  return mask;
}
/// 1 for the lanes of a mask, else 0.
template <class Real>
Real as_number(AllLanes) {
  return Real(1.0);
}
template <class Real, class Mask>
Real as_number(const Mask& mask) {
  return select(mask, Real(1.0), Real(0.0));
}

/// Returns whether the bearing has a derivative; otherwise the detection is left out (EQUATIONS 2).
template <class Real>
[[gnu::always_inline]] inline auto is_usable(const LineOfSight<Real>& s) {
  return s.predicted.range > Real(kLeastDistance);
}

/// The innovation of a detection for a pose Gaussian (EQUATIONS 6).
template <class Real>
struct Innovation {
  Measurement<Real> value;
  Symmetric2<Real> S;               ///< covariance of `value`
  Column3<Real> first{}, second{};  ///< columns of P Hx', one for each component of `value`

  /// value' S^-1 value.
  Real squared() const { return squared(value); }
  /// Returns other' S^-1 other for another innovation with the covariance S.
  Real squared(const Measurement<Real>& other) const {
    return S.adjugate_form(other.first, other.second) / S.determinant();
  }
};

/// The innovation of range and bearing, for which Hx = [-ux -uy 0; uy/d -ux/d -1].
template <class Real>
[[gnu::always_inline]] inline Innovation<Real> innovation_of(const Symmetric3<Real>& P,
                                                             const LineOfSight<Real>& s,
                                                             const Measurement<Real>& value,
                                                             const Symmetric2<Real>& map_covariance,
                                                             const SensorNoise& noise) {
  const Turned<Real> map = turned(map_covariance, s);
  const Real cx = s.ux * s.per_range, cy = s.uy * s.per_range;
  const Column3<Real> range{-(P.xx * s.ux + P.xy * s.uy), -(P.xy * s.ux + P.yy * s.uy),
                            -(P.xh * s.ux + P.yh * s.uy)};
  const Column3<Real> bearing{P.xx * cy - P.xy * cx - P.xh, P.xy * cy - P.yy * cx - P.yh,
                              P.xh * cy - P.yh * cx - P.hh};
  return {value,
          {noise.first + map.along - (s.ux * range.x + s.uy * range.y),
           map.cross * s.per_range - (s.ux * bearing.x + s.uy * bearing.y),
           noise.second + map.across * s.per_range * s.per_range + cy * bearing.x - cx * bearing.y -
               bearing.h},
          range,
          bearing};
}

/// The terms of N(innovation; S); (0, 1) in lanes without an update.
template <class Real>
struct Density {
  Real squared, determinant;
};

/// The two components of an innovation made uncorrelated, so that both are scalar updates: the
/// first, and the second minus its regression on the first. Lanes outside `use` get zero gains.
template <class Real>
struct Decorrelated {
  Real per_first, per_second;  ///< 1 / variance of each component
  Real slope;                  ///< regression of the second on the first
  Real first, second;          ///< values of the two
  Density<Real> density;

  template <class Mask>
  [[gnu::always_inline]] Decorrelated(const Innovation<Real>& v, const Mask& use) {
    const Real determinant = v.S.determinant();
    const Real inverse = select(use, 1.0 / (v.S.xx * determinant), Real(0.0));
    per_first = determinant * inverse;
    per_second = v.S.xx * v.S.xx * inverse;
    slope = v.S.xy * per_first;
    first = v.value.first;
    second = v.value.second - slope * first;
    density = {first * first * per_first + second * second * per_second,
               select(use, determinant, Real(1.0))};
  }
};

/// Kalman update of a pose by an innovation, in the lanes of `use` (EQUATIONS 6).
template <class Real, class Mask>
[[gnu::always_inline]] inline Density<Real> condition(PoseGaussian<Real>& pose,
                                                      const Innovation<Real>& v, const Mask& use) {
  const Decorrelated<Real> d(v, use);
  const Column3<Real> second = v.second - d.slope * v.first;
  const Column3<Real> gain_of_first = d.per_first * v.first, gain_of_second = d.per_second * second;
  const Column3<Real> step = d.first * gain_of_first + d.second * gain_of_second;
  pose.mean = {pose.mean.x + step.x, pose.mean.y + step.y, pose.mean.heading + step.h};
  pose.covariance = pose.covariance - outer(gain_of_first, v.first) - outer(gain_of_second, second);
  return d.density;
}

/// Updates a pose Gaussian with one detection by the extended Kalman filter (EQUATIONS 6), with the
/// model linearised on the line_of_sight `s`. `matched` is the mask of the lanes that matched it.
template <class Real, class Mask>
[[gnu::always_inline]] inline Innovation<Real> update_with(
    PoseGaussian<Real>& pose, const LineOfSight<Real>& s, const Measurement<Real>& value,
    const Symmetric2<Real>& map_covariance, const SensorNoise& noise, const Mask& matched,
    Evidence<Real>& evidence) {
  const auto use = matched && is_usable(s);
  Innovation<Real> v = innovation_of(pose.covariance, s, value, map_covariance, noise);
  const Density<Real> density = condition(pose, v, use);
  evidence.add(density.squared, density.determinant, as_number<Real>(use),
               as_number<Real>(matched));
  return v;
}

/// Updates a pose Gaussian with a fix of the position of this variance [m^2], for which Hx is one
/// for the position and zero else. Returns the log of the density of the innovation.
template <class Real>
Real update_with_fix(PoseGaussian<Real>& pose, const PositionFix& fix, double variance) {
  const Symmetric3<Real>& P = pose.covariance;
  const Innovation<Real> v{{Real(fix.x() - pose.mean.x), Real(fix.y() - pose.mean.y)},
                           {P.xx + variance, P.xy, P.yy + variance},
                           {P.xx, P.xy, P.xh},
                           {P.xy, P.yy, P.yh}};
  const auto everywhere = Real(0.0) == Real(0.0);
  const Density<Real> density = condition(pose, v, everywhere);
  Evidence<Real> evidence;
  evidence.add(density.squared, density.determinant, Real(1.0), Real(1.0));
  return evidence.log_density();
}

/// A displacement along and across the line of sight, rotated into the map.
template <class Real>
[[gnu::always_inline]] inline BasicPoint<Real> in_map(const Real& along, const Real& across,
                                                      const LineOfSight<Real>& s) {
  return {s.ux * along - s.uy * across, s.uy * along + s.ux * across};
}

/// Inverse of turned(): rotates a covariance back into the map.
template <class Real>
[[gnu::always_inline]] inline Symmetric2<Real> turned_back(const Turned<Real>& P,
                                                           const LineOfSight<Real>& s) {
  const Real along_x = s.ux * P.along - s.uy * P.cross, along_y = s.uy * P.along + s.ux * P.cross;
  const Real across_x = s.ux * P.cross - s.uy * P.across;
  const Real across_y = s.uy * P.cross + s.ux * P.across;
  return {along_x * s.ux - across_x * s.uy, along_x * s.uy + across_x * s.ux,
          along_y * s.uy + across_y * s.ux};
}

/// Moments by the extended Kalman filter (EQUATIONS 3).
struct Linearised {
  static constexpr bool kRefinesInBatch = true;
  void advance(MotionIncrement& motion, const Control& control, double duration,
               const Belief& belief) const {
    motion.advance(control, duration, belief);
  }
  /// update_with(), linearised at the refined pose: sequential refinement (EQUATIONS 6).
  template <class Real, class Mask>
  [[gnu::always_inline]] Innovation<Real> refine(PoseGaussian<Real>& pose,
                                                 const LandmarkGaussian<Real>& landmark,
                                                 const Measurement<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Evidence<Real>& evidence) const {
    const LineOfSight<Real> s = line_of_sight(pose.mean, landmark.mean);
    return update_with(pose, s, residual(seen, s), landmark.covariance, noise, matched, evidence);
  }
  /// update_with(), linearised at the predicted pose for all detections. The sequence of updates
  /// then equals the batch update with the stacked innovation, and its evidence is N(nu; S)
  /// (EQUATIONS (6.4)).
  template <class Real, class Mask>
  void refine_in_batch(PoseGaussian<Real>& pose, const BasicPose<Real>& predicted,
                       const LandmarkGaussian<Real>& landmark, const Measurement<Real>& seen,
                       const SensorNoise& noise, const Mask& matched,
                       Evidence<Real>& evidence) const {
    const LineOfSight<Real> s = line_of_sight(predicted, landmark.mean);
    Measurement<Real> innovation = residual(seen, s);
    const Column3<Real> moved{pose.mean.x - predicted.x, pose.mean.y - predicted.y,
                              pose.mean.heading - predicted.heading};
    innovation.first += s.ux * moved.x + s.uy * moved.y;
    innovation.second += (s.ux * moved.y - s.uy * moved.x) * s.per_range + moved.h;
    update_with(pose, s, innovation, landmark.covariance, noise, matched, evidence);
  }
  /// Updates a landmark with one detection from an exactly known pose (EQUATIONS 4). In the frame
  /// of the line of sight the noise R is diagonal, and the new covariance P (P + R)^-1 R has no
  /// difference that could become negative; the gain is that times R^-1.
  template <class Real, class Mask, class Weighed>
  [[gnu::always_inline]] Innovation<Real> update(LandmarkGaussian<Real>& landmark,
                                                 const BasicPose<Real>& pose,
                                                 const Measurement<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Weighed& evidence) const {
    const LineOfSight<Real> s = line_of_sight(pose, landmark.mean);
    const auto use = matched && is_usable(s);
    const Turned<Real> P = turned(landmark.covariance, s);
    const Measurement<Real> innovation = residual(seen, s);
    const Real along = innovation.first, across = innovation.second * s.predicted.range;
    const Turned<Real> R{noise.first, Real(0.0),
                         noise.second * s.predicted.range * s.predicted.range};
    const Symmetric2<Real> S{P.along + R.along, P.cross, P.across + R.across};
    const Real determinant = S.determinant();
    const Real inverse = select(use, 1.0 / determinant, Real(0.0));

    const Real determinant_of_map = P.along * P.across - P.cross * P.cross;
    const Turned<Real> g{(determinant_of_map + P.along * R.across) * inverse, P.cross * inverse,
                         (determinant_of_map + P.across * R.along) * inverse};
    const Real move_along = g.along * along + g.cross * R.along * across;
    const Real move_across = g.cross * R.across * along + g.across * across;
    landmark.mean = landmark.mean + in_map(move_along, move_across, s);
    const Symmetric2<Real> after = turned_back(
        Turned<Real>{g.along * R.along, g.cross * R.along * R.across, g.across * R.across}, s);
    landmark.covariance = select(use, after, landmark.covariance);
    evidence.add(S.adjugate_form(along, across) * inverse,
                 select(use, determinant * s.per_range * s.per_range, Real(1.0)),
                 as_number<Real>(use), as_number<Real>(matched));
    return {innovation, {S.xx, S.xy * s.per_range, S.yy * s.per_range * s.per_range}};
  }
  /// Initialises a landmark from an exactly known pose: g(x, z) and Gz R Gz' (EQUATIONS 4).
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const Measurement<Real>& seen,
                                    const SensorNoise& noise) const {
    const LinearisedPlace<Real> place =
        linearised_place(pose, RangeBearing<Real>{seen.first, seen.second});
    const Real range = noise.first, bearing = noise.second;
    return {place.point,
            {place.x_range * place.x_range * range + place.x_bearing * place.x_bearing * bearing,
             place.x_range * place.y_range * range + place.x_bearing * place.y_bearing * bearing,
             place.y_range * place.y_range * range + place.y_bearing * place.y_bearing * bearing}};
  }
};

}  // namespace montecarta::filters
