// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/sigma_observation.hpp"

namespace montecarta::filters {

/// Whether a landmark's own covariance is part of the innovation that moves the pose. Kim 2008 and
/// Ankishan eq. (16)-(18) print it without; it always is part of the weight (EQUATIONS 7).
enum class MapUncertainty { on, off };

/// Column of three given along and across the line of sight, turned into the map.
template <class Real>
[[gnu::always_inline]] inline Column3<Real> in_map(const Real& along, const Real& across,
                                                   const Real& heading,
                                                   const LineOfSight<Real>& s) {
  const BasicPoint<Real> place = in_map(along, across, s);
  return {place.x, place.y, heading};
}

/// An observation predicted by the sigma points of (pose, landmark).
template <class Real>
struct SigmaObservation {
  Innovation<Real> whole;     ///< with the landmark's covariance: what weighs
  Innovation<Real> proposal;  ///< what moves the pose, with the cross-covariances
};

template <class Real>
[[gnu::always_inline]] inline SigmaObservation<Real> sigma_observation_of(
    const Symmetric3<Real>& covariance, const Symmetric2<Real>& map_covariance,
    const LineOfSight<Real>& s, const RangeBearing<Real>& seen, const SensorNoise& noise,
    const SigmaRule& rule, MapUncertainty map_uncertainty) {
  const Symmetric3<Real> P = turned(covariance, Direction<Real>{s.ux, -s.uy});
  const Turned<Real> map = turned(map_covariance, s);
  const AcrossColumn<Real> q = across_column(P), m = across_column(map);
  const Real& range = s.predicted.range;

  // P_zz(x) + R of EQUATIONS (7.1) by (3.8), then P_zz(mu) beside it. The pose moves against the
  // landmark, and its heading against the bearing.
  ObservationPair<Real> pair =
      observation_pair(range, rule.spread * q.along, rule.spread * q.across);
  pair.odd = {-pair.odd.range, -pair.odd.bearing - rule.spread * q.heading};
  const Real aa = P.xx - q.along * q.along;  // of the columns after the first
  const Real ah = P.xh - q.along * q.heading, hh = P.hh - q.heading * q.heading;
  ObservationMoments<Real> own{.covariance = {noise.range + aa, ah, noise.bearing + hh}};
  own.add(pair, rule);
  ObservationMoments<Real> whole = own;
  whole.add(observation_pair(range, rule.spread * m.along, rule.spread * m.across), rule);
  whole.covariance.xx += map.along - m.along * m.along;

  SigmaObservation<Real> observation;
  observation.whole = whole.innovation(seen, s, rule);
  observation.proposal =
      map_uncertainty == MapUncertainty::on ? observation.whole : own.innovation(seen, s, rule);
  const Real r = rule.antisymmetric * rule.spread * pair.odd.range;
  const Real b = rule.antisymmetric * rule.spread * pair.odd.bearing;
  observation.proposal.range = in_map(q.along * r - aa, q.across * r, q.heading * r - ah, s);
  observation.proposal.bearing = in_map(q.along * b - ah, q.across * b, q.heading * b - hh, s);
  return observation;
}

/// Updates with one detection a pose Gaussian by (3.2) with the moments of (7.1) (EQUATIONS 7, 8),
/// sigma points drawn anew from what the detection before left. `matched`: which lanes saw it.
template <class Real, class Mask>
[[gnu::always_inline]] inline Innovation<Real> refine_pose_by_sigma_points(
    PoseGaussian<Real>& pose, const LandmarkGaussian<Real>& landmark,
    const RangeBearing<Real>& seen, const SensorNoise& noise, const Mask& matched,
    Evidence<Real>& evidence, const SigmaRule& rule, MapUncertainty map_uncertainty) {
  const LineOfSight<Real> s = line_of_sight(pose.mean, landmark.mean);
  const auto use = matched && is_usable(s);
  const SigmaObservation<Real> observation = sigma_observation_of(
      pose.covariance, landmark.covariance, s, seen, noise, rule, map_uncertainty);
  Density<Real> density = condition(pose, observation.proposal, use);
  if (map_uncertainty == MapUncertainty::off) {
    density = {select(use, observation.whole.squared(), Real(0.0)),
               select(use, observation.whole.S.determinant(), Real(1.0))};
  }
  evidence.add(density.squared, density.determinant, as_number<Real>(use),
               as_number<Real>(matched));
  return observation.whole;
}

}  // namespace montecarta::filters
