// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/correlated_anchored.hpp"
#include "filters/moments/correlated_birth.hpp"
#include "filters/moments/correlated_motion.hpp"
#include "filters/moments/correlated_sight.hpp"
#include "filters/moments/sigma_landmark.hpp"

/// Models made straight by sigma points (SPEC 8, 9) where pose and map are correlated. The square
/// root has first the one number in which the model bends: the place across the line of sight,
/// relative to the pose; the sum of heading and bearing of a new landmark; the heading of a motion.
/// Its column alone is sent through the model, every other is carried along unchanged.
namespace montecarta {

template <class Real>
[[gnu::always_inline]] inline StraightSight<Real> sight_by_sigma_points(
    const Sightline<Real>& s, const Symmetric2<Real>& relative, const RangeBearing<Real>& seen,
    const SensorNoise& noise, const SigmaRule& rule) {
  const Turned<Real> P = turned(relative, s);
  const AcrossColumn<Real> column = across_column(P);
  const Real per_across = inverse_root(P.across);
  const auto [odd, even] =
      sight_pair(s.predicted.range, rule.spread * column.along, rule.spread * column.across);
  const double per_spread = rule.antisymmetric * rule.spread, bend = bend_weight(rule);
  return {residual(seen, s, {rule.mean_weight * even.range, rule.mean_weight * even.bearing}),
          (per_spread * odd.range - column.along) * per_across,
          select(per_across > Real(0.0), per_spread * odd.bearing * per_across, s.per_range),
          noise.range + bend * even.range * even.range,
          bend * even.range * even.bearing,
          noise.bearing + bend * even.bearing * even.bearing};
}

/// An angle's two points, in standard deviations of it: the slope of the sine, and how far the
/// middle of the cosines lies from one.
template <class Real>
struct ArcPair {
  Real slope, even;
};

template <class Real>
ArcPair<Real> arc_pair(const Real& variance, const SigmaRule& rule) {
  const Real per_sigma = inverse_root(variance);
  const Direction<Real> d = direction_of(Real(rule.spread * variance * per_sigma));
  return {select(per_sigma > Real(0.0), rule.antisymmetric * rule.spread * d.sine * per_sigma,
                 Real(1.0)),
          d.cosine - 1.0};
}

template <class Real>
StraightTurn<Real> turn_by_sigma_points(const Real& heading_variance, const SigmaRule& rule) {
  const ArcPair<Real> arc = arc_pair(heading_variance, rule);
  return {1.0 + rule.mean_weight * arc.even, arc.slope, bend_weight(rule) * arc.even * arc.even};
}

template <class Real>
StraightPlace<Real> place_by_sigma_points(const Real& heading_variance,
                                          const RangeBearing<Real>& seen, const SensorNoise& noise,
                                          const SigmaRule& rule) {
  const ArcPair<Real> arc = arc_pair(Real(heading_variance + noise.bearing), rule);
  const Real even = seen.range * arc.even;
  return {seen.range + rule.mean_weight * even, seen.range * arc.slope,
          noise.range + bend_weight(rule) * even * even};
}

/// What an anchor sees bends in two columns: that of heading plus bearing, and of what is left the
/// place across the ray. `P`: (along, across, heading) of the pose.
template <class Real>
StraightBirth<Real> birth_by_sigma_points(const Symmetric3<Real>& P, const RangeBearing<Real>& seen,
                                          const SensorNoise& noise, const SigmaRule& rule) {
  const Real per_turn = inverse_root(Real(P.hh + noise.bearing));
  const Real along = P.xh * per_turn, across = P.yh * per_turn;
  const Turned<Real> rest{P.xx - along * along, P.xy - along * across, P.yy - across * across};
  const Real per_across = inverse_root(rest.across);
  const AcrossColumn<Real> column = across_column(rest);
  const SightPair<Real> shifted =
      sight_pair(seen.range, rule.spread * column.along, rule.spread * column.across);
  const Direction<Real> d = direction_of(Real(rule.spread * (P.hh + noise.bearing) * per_turn));
  SightPair<Real> turned = sight_pair(Real(seen.range * d.cosine), rule.spread * along,
                                      seen.range * d.sine + rule.spread * across);
  turned.even.range += seen.range * (d.cosine - 1.0);

  SightMoments<Real> bent{.rr = Real(noise.range), .rb = Real(0.0), .bb = Real(0.0)};
  bent.add({{}, shifted.even}, rule);
  bent.add({{}, turned.even}, rule);
  const double per_spread = rule.antisymmetric * rule.spread;
  const RangeBearing<Real> by_across{
      (per_spread * shifted.odd.range - column.along) * per_across,
      select(per_across > Real(0.0), per_spread * shifted.odd.bearing * per_across,
             1.0 / max(seen.range, Real(kLeastDistance)))};
  return {{seen.range + bent.shift.range, seen.bearing + bent.shift.bearing},
          by_across,
          {(per_spread * turned.odd.range - by_across.range * across - along) * per_turn,
           select(per_turn > Real(0.0),
                  (per_spread * turned.odd.bearing - by_across.bearing * across) * per_turn,
                  Real(1.0))},
          bent.rr + rule.shift * bent.shift.range * bent.shift.range,
          bent.rb + rule.shift * bent.shift.range * bent.shift.bearing,
          bent.bb + rule.shift * bent.shift.bearing * bent.shift.bearing};
}

}  // namespace montecarta
