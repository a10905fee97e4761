// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/sigma_observation.hpp"

namespace montecarta::filters {

/// What one pair of points contributes to the covariance by its bend: E E' times this, e e' of the
/// single pair included.
inline double bend_weight(const SigmaRule& rule) {
  return rule.symmetric + rule.shift * rule.mean_weight * rule.mean_weight;
}

/// Gain of a landmark: (along, across) the line of sight by (range, bearing).
template <class Real>
struct LandmarkGain {
  Real along_range, along_bearing, across_range, across_bearing;
};

/// A landmark seen from an exactly known pose, by the sigma points of its Gaussian, in the frame of
/// the line of sight.
template <class Real>
struct LandmarkObservation {
  AcrossColumn<Real> column;  ///< first column of the square root
  RangeBearing<Real> slope;   ///< its image
  Real rest;                  ///< square of the second column, which lies along the line
  Symmetric2<Real> N;         ///< covariance of what no column of the landmark explains
  Innovation<Real> innovation;

  [[gnu::always_inline]] LandmarkObservation(const Symmetric2<Real>& covariance,
                                             const LineOfSight<Real>& s,
                                             const RangeBearing<Real>& seen,
                                             const SensorNoise& noise, const SigmaRule& rule) {
    const Turned<Real> P = turned(covariance, s);
    column = across_column(P);
    rest = P.along - column.along * column.along;
    const auto [odd, even] = observation_pair(s.predicted.range, rule.spread * column.along,
                                              rule.spread * column.across);
    const double per_spread = rule.antisymmetric * rule.spread, bend = bend_weight(rule);
    slope = {per_spread * odd.range, per_spread * odd.bearing};
    N = outer(bend, even);
    N.xx += noise.range, N.yy += noise.bearing;
    innovation = {
        residual(seen, s, {rule.mean_weight * even.range, rule.mean_weight * even.bearing}),
        Symmetric2<Real>{N.xx + rest, N.xy, N.yy} + outer(1.0, slope)};
  }

  /// K = P_xz S^-1; `inverse` = 1 / det S, or 0 where there is no update.
  [[gnu::always_inline]] LandmarkGain<Real> gain(const Real& inverse) const {
    const Real a_r = column.along * slope.range + rest, a_b = column.along * slope.bearing;
    const Real c_r = column.across * slope.range, c_b = column.across * slope.bearing;
    const Symmetric2<Real>& S = innovation.S;
    return {(a_r * S.yy - a_b * S.xy) * inverse, (a_b * S.xx - a_r * S.xy) * inverse,
            (c_r * S.yy - c_b * S.xy) * inverse, (c_b * S.xx - c_r * S.xy) * inverse};
  }

  /// [S - K A, K sqrt(N)] times its transpose: a sum of squares, nothing to turn negative
  /// (EQUATIONS 3).
  [[gnu::always_inline]] Turned<Real> after(const LandmarkGain<Real>& K) const {
    const Real a = column.along - K.along_range * slope.range - K.along_bearing * slope.bearing;
    const Real c = column.across - K.across_range * slope.range - K.across_bearing * slope.bearing;
    const Real rest_a = 1.0 - K.along_range, rest_c = -K.across_range;
    const Real a_r = K.along_range * N.xx + K.along_bearing * N.xy;
    const Real a_b = K.along_range * N.xy + K.along_bearing * N.yy;
    const Real c_r = K.across_range * N.xx + K.across_bearing * N.xy;
    const Real c_b = K.across_range * N.xy + K.across_bearing * N.yy;
    return {a * a + rest * rest_a * rest_a + a_r * K.along_range + a_b * K.along_bearing,
            a * c + rest * rest_a * rest_c + a_r * K.across_range + a_b * K.across_bearing,
            c * c + rest * rest_c * rest_c + c_r * K.across_range + c_b * K.across_bearing};
  }
};

/// Updates with one detection a landmark seen from an exactly known pose (EQUATIONS 7, 8).
template <class Real, class Mask, class Weighed>
[[gnu::always_inline]] inline Innovation<Real> update_landmark_by_sigma_points(
    LandmarkGaussian<Real>& landmark, const BasicPose<Real>& pose, const RangeBearing<Real>& seen,
    const SensorNoise& noise, const Mask& matched, Weighed& evidence, const SigmaRule& rule) {
  const LineOfSight<Real> s = line_of_sight(pose, landmark.mean);
  const auto use = matched && is_usable(s);
  const LandmarkObservation<Real> observation(landmark.covariance, s, seen, noise, rule);
  const Innovation<Real>& v = observation.innovation;
  const Real determinant = v.S.determinant();
  const Real inverse = select(use, 1.0 / determinant, Real(0.0));
  const LandmarkGain<Real> K = observation.gain(inverse);
  const Real along = K.along_range * v.value.range + K.along_bearing * v.value.bearing;
  const Real across = K.across_range * v.value.range + K.across_bearing * v.value.bearing;
  landmark.mean = landmark.mean + in_map(along, across, s);
  landmark.covariance = select(use, turned_back(observation.after(K), s), landmark.covariance);
  evidence.add(v.S.adjugate_form(v.value.range, v.value.bearing) * inverse,
               select(use, determinant, Real(1.0)), as_number<Real>(use), as_number<Real>(matched));
  return v;
}

/// A landmark seen for the first time from an exactly known pose: the points z +- spread sqrt(R)
/// e_i sent through g(x, .) (EQUATIONS 8). The range's points lie on the ray; those of the bearing
/// stand `ray` = (cos, sin)(spread sigma_bearing) to both sides of it.
template <class Real>
LandmarkGaussian<Real> new_landmark_by_sigma_points(const BasicPose<Real>& pose,
                                                    const RangeBearing<Real>& seen,
                                                    const SensorNoise& noise, const SigmaRule& rule,
                                                    const Direction<double>& ray) {
  const Direction<Real> d = direction_of(Real(pose.heading + seen.bearing));
  const Real odd = seen.range * ray.sine, even = seen.range * (ray.cosine - 1.0);
  const Real way = seen.range + rule.mean_weight * even;
  const Real along = noise.range + bend_weight(rule) * even * even;
  const Real across = rule.antisymmetric * odd * odd;
  return {
      {pose.x + way * d.cosine, pose.y + way * d.sine},
      {along * d.cosine * d.cosine + across * d.sine * d.sine, (along - across) * d.cosine * d.sine,
       along * d.sine * d.sine + across * d.cosine * d.cosine}};
}

}  // namespace montecarta::filters
