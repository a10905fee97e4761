// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/linearised.hpp"
#include "filters/moments/sigma_rule.hpp"

/// Sigma points of an observation (EQUATIONS 3), in the frame of the line of sight. The square
/// roots there have the component across the line first, because range and bearing are curved in
/// that one alone: every other column leaves the relative position on the line, where the range is
/// minus `along` and the bearing minus `heading` exactly, so that its two points need not be looked
/// at. What is left of a covariance without its first column enters as it stands.
namespace montecarta::filters {

/// The column of a lower triangular square root that carries the component across.
template <class Real>
struct AcrossColumn {
  Real along, across, heading;
};

/// 1 / sqrt(square), or 0 where the square is zero but for rounding.
template <class Real>
[[gnu::always_inline]] inline Real inverse_root(const Real& square) {
  return select(square > 1e-18 * (Real(1.0) + square), Real(1.0) / sqrt(square), Real(0.0));
}
template <class Real>
[[gnu::always_inline]] inline AcrossColumn<Real> across_column(const Symmetric3<Real>& P) {
  const Real inverse = inverse_root(P.yy);
  return {P.xy * inverse, P.yy * inverse, P.yh * inverse};
}
template <class Real>
[[gnu::always_inline]] inline AcrossColumn<Real> across_column(const Turned<Real>& P) {
  const Real inverse = inverse_root(P.across);
  return {P.cross * inverse, P.across * inverse, Real(0.0)};
}

/// Of two points' observations: D, half their difference, and E, how far their middle lies from the
/// centre's.
template <class Real>
struct ObservationPair {
  RangeBearing<Real> odd, even;
};

/// Observations of (range + along, across) and (range - along, -across), bearings from the line of
/// sight: small, so nothing wraps.
template <class Real>
[[gnu::always_inline]] inline ObservationPair<Real> observation_pair(const Real& range,
                                                                     const Real& along,
                                                                     const Real& across) {
  const Real far = range + along, near = range - along;
  const Real square = across * across;
  const Real far_range = sqrt(far * far + square), near_range = sqrt(near * near + square);
  const Real far_bearing = atan2(across, far), near_bearing = atan2(across, near);  // left, right
  return {{0.5 * (far_range - near_range), 0.5 * (far_bearing + near_bearing)},
          {0.5 * (far_range + near_range) - range, 0.5 * (far_bearing - near_bearing)}};
}

/// detected boxminus predicted, where the mean of the predicted observations lies `shift` from the
/// centre's.
template <class Real>
[[gnu::always_inline]] inline RangeBearing<Real> residual(const RangeBearing<Real>& detected,
                                                          const LineOfSight<Real>& s,
                                                          const RangeBearing<Real>& shift) {
  return {detected.range - s.predicted.range - shift.range,
          shorter_way(Real(detected.bearing - s.predicted.bearing - shift.bearing))};
}

/// Moments of a predicted observation (EQUATIONS (3.8)), gathered column by column.
template <class Real>
struct ObservationMoments {
  Symmetric2<Real> covariance;                     ///< as yet without the term in e e'
  RangeBearing<Real> shift{Real(0.0), Real(0.0)};  ///< e: of the mean from the centre's observation

  [[gnu::always_inline]] void add(const ObservationPair<Real>& pair, const SigmaRule& rule) {
    shift.range += rule.mean_weight * pair.even.range;
    shift.bearing += rule.mean_weight * pair.even.bearing;
    covariance =
        covariance + (outer(rule.antisymmetric, pair.odd) + outer(rule.symmetric, pair.even));
  }
  /// The innovation of `seen`, with cross-covariances for the caller to fill in.
  [[gnu::always_inline]] Innovation<Real> innovation(const RangeBearing<Real>& seen,
                                                     const LineOfSight<Real>& s,
                                                     const SigmaRule& rule) const {
    return {residual(seen, s, shift), covariance + outer(rule.shift, shift)};
  }
};

}  // namespace montecarta::filters
