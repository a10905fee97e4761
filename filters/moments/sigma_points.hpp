// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/control_motion.hpp"
#include "filters/moments/linearised.hpp"

/// Sigma points of an observation (EQUATIONS 3) in the frame of the line of sight. The square roots
/// in this frame have the component across the line first, since range and bearing are nonlinear in
/// that one only. Every other column keeps the relative position on the line, where the range is
/// exactly minus `along` and the bearing minus `heading`, so that its two points need not be
/// computed. The rest of a covariance without its first column is used as it is.
namespace montecarta::filters {

/// The column of a lower triangular square root that has the component across.
template <class Real>
struct AcrossColumn {
  Real along, across, heading;
};

/// 1 / sqrt(square), or 0 if the square is zero up to rounding.
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

/// The observations of two opposite points: D, half their difference, and E, the deviation of their
/// mean from the observation of the centre.
template <class Real>
struct ObservationPair {
  Measurement<Real> odd, even;
};

/// The pair of observations of (range + along, across) and (range - along, -across), with bearings
/// relative to the line of sight, which are small and do not wrap.
template <class Real>
[[gnu::always_inline]] inline ObservationPair<Real> observation_pair(const Real& range,
                                                                     const Real& along,
                                                                     const Real& across) {
  const Real far = range + along, near = range - along;
  const Real square = across * across;
  const Real far_range = sqrt(far * far + square), near_range = sqrt(near * near + square);
  // The far point is on the left, the near one on the right.
  const Real far_bearing = atan2(across, far), near_bearing = atan2(across, near);
  return {{0.5 * (far_range - near_range), 0.5 * (far_bearing + near_bearing)},
          {0.5 * (far_range + near_range) - range, 0.5 * (far_bearing - near_bearing)}};
}

/// Innovation, detected minus predicted, if the mean of the predicted observations deviates by
/// `shift` from that of the centre.
template <class Real>
[[gnu::always_inline]] inline Measurement<Real> residual(const Measurement<Real>& detected,
                                                         const LineOfSight<Real>& s,
                                                         const Measurement<Real>& shift) {
  return {detected.first - s.predicted.range - shift.first,
          shorter_way(Real(detected.second - s.predicted.bearing - shift.second))};
}

/// Moments of a predicted observation (EQUATIONS (3.8)), summed column by column.
template <class Real>
struct ObservationMoments {
  Symmetric2<Real> covariance;                    ///< covariance without the term in e e'
  Measurement<Real> shift{Real(0.0), Real(0.0)};  ///< e: mean minus observation of the centre

  [[gnu::always_inline]] void add(const ObservationPair<Real>& pair, const SigmaRule& rule) {
    shift.first += rule.mean_weight * pair.even.first;
    shift.second += rule.mean_weight * pair.even.second;
    covariance =
        covariance + (outer(rule.antisymmetric, pair.odd) + outer(rule.symmetric, pair.even));
  }
  /// The innovation of `seen`, with cross-covariances for the caller to fill in.
  [[gnu::always_inline]] Innovation<Real> innovation(const Measurement<Real>& seen,
                                                     const LineOfSight<Real>& s,
                                                     const SigmaRule& rule) const {
    return {residual(seen, s, shift), covariance + outer(rule.shift, shift)};
  }
};

/// The use of the landmark's covariance in the innovation that moves the pose. Kim 2008 and
/// Ankishan eq. (16)-(18) print it without; the weight always includes it (EQUATIONS 7).
enum class MapUncertainty { on, off };

/// A column given along and across the line of sight, rotated into the map.
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
  Innovation<Real> whole;     ///< innovation that gives the weight, with the landmark's covariance
  Innovation<Real> proposal;  ///< innovation that moves the pose, with the cross-covariances
};

template <class Real>
[[gnu::always_inline]] inline SigmaObservation<Real> sigma_observation_of(
    const Symmetric3<Real>& covariance, const Symmetric2<Real>& map_covariance,
    const LineOfSight<Real>& s, const Measurement<Real>& seen, const SensorNoise& noise,
    const SigmaRule& rule, MapUncertainty map_uncertainty) {
  const Symmetric3<Real> P = turned(covariance, Direction<Real>{s.ux, -s.uy});
  const Turned<Real> map = turned(map_covariance, s);
  const AcrossColumn<Real> q = across_column(P), m = across_column(map);
  const Real& range = s.predicted.range;

  // P_zz(x) + R of EQUATIONS (7.1) by (3.8), then P_zz(mu). A displacement of the pose acts
  // opposite to one of the landmark, and a turn of the heading opposite to one of the bearing.
  ObservationPair<Real> pair =
      observation_pair(range, rule.spread * q.along, rule.spread * q.across);
  pair.odd = {-pair.odd.first, -pair.odd.second - rule.spread * q.heading};
  const Real aa = P.xx - q.along * q.along;  // covariance of the columns after the first
  const Real ah = P.xh - q.along * q.heading, hh = P.hh - q.heading * q.heading;
  ObservationMoments<Real> own{.covariance = {noise.first + aa, ah, noise.second + hh}};
  own.add(pair, rule);
  ObservationMoments<Real> whole = own;
  whole.add(observation_pair(range, rule.spread * m.along, rule.spread * m.across), rule);
  whole.covariance.xx += map.along - m.along * m.along;

  SigmaObservation<Real> observation;
  observation.whole = whole.innovation(seen, s, rule);
  observation.proposal =
      map_uncertainty == MapUncertainty::on ? observation.whole : own.innovation(seen, s, rule);
  const Real r = rule.antisymmetric * rule.spread * pair.odd.first;
  const Real b = rule.antisymmetric * rule.spread * pair.odd.second;
  observation.proposal.first = in_map(q.along * r - aa, q.across * r, q.heading * r - ah, s);
  observation.proposal.second = in_map(q.along * b - ah, q.across * b, q.heading * b - hh, s);
  return observation;
}

/// Weight of E E' of one pair of points in the covariance, including e e' if this is the only pair.
inline double bend_weight(const SigmaRule& rule) {
  return rule.symmetric + rule.shift * rule.mean_weight * rule.mean_weight;
}

/// Gain of a landmark: (along, across) the line of sight by (range, bearing).
template <class Real>
struct LandmarkGain {
  Real along_range, along_bearing, across_range, across_bearing;
};

/// A landmark observed from an exactly known pose, by the sigma points of its Gaussian, in the
/// frame of the line of sight.
template <class Real>
struct LandmarkObservation {
  AcrossColumn<Real> column;  ///< first column of the square root
  Measurement<Real> slope;    ///< image of that column
  Real rest;                  ///< square of the second column, which lies along the line
  Symmetric2<Real> N;         ///< covariance not explained by any column of the landmark
  Innovation<Real> innovation;

  [[gnu::always_inline]] LandmarkObservation(const Symmetric2<Real>& covariance,
                                             const LineOfSight<Real>& s,
                                             const Measurement<Real>& seen,
                                             const SensorNoise& noise, const SigmaRule& rule) {
    const Turned<Real> P = turned(covariance, s);
    column = across_column(P);
    rest = P.along - column.along * column.along;
    const auto [odd, even] = observation_pair(s.predicted.range, rule.spread * column.along,
                                              rule.spread * column.across);
    const double per_spread = rule.antisymmetric * rule.spread, turning_angle = bend_weight(rule);
    slope = {per_spread * odd.first, per_spread * odd.second};
    N = outer(turning_angle, even);
    N.xx += noise.first, N.yy += noise.second;
    innovation = {
        residual(seen, s, {rule.mean_weight * even.first, rule.mean_weight * even.second}),
        Symmetric2<Real>{N.xx + rest, N.xy, N.yy} + outer(1.0, slope)};
  }

  /// K = P_xz S^-1; `inverse` is 1 / det S, or 0 in lanes without an update.
  [[gnu::always_inline]] LandmarkGain<Real> gain(const Real& inverse) const {
    const Real a_r = column.along * slope.first + rest, a_b = column.along * slope.second;
    const Real c_r = column.across * slope.first, c_b = column.across * slope.second;
    const Symmetric2<Real>& S = innovation.S;
    return {(a_r * S.yy - a_b * S.xy) * inverse, (a_b * S.xx - a_r * S.xy) * inverse,
            (c_r * S.yy - c_b * S.xy) * inverse, (c_b * S.xx - c_r * S.xy) * inverse};
  }

  /// [S - K A, K sqrt(N)] times its transpose, a sum of squares that cannot become negative
  /// (EQUATIONS 3).
  [[gnu::always_inline]] Turned<Real> after(const LandmarkGain<Real>& K) const {
    const Real a = column.along - K.along_range * slope.first - K.along_bearing * slope.second;
    const Real c = column.across - K.across_range * slope.first - K.across_bearing * slope.second;
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

/// The covariance of a new landmark: (8.3), or that of Ankishan (24), (25), to which R is added
/// once more, as if range and bearing were x and y.
enum class NewLandmarks { corrected, as_printed };

/// Moments by sigma points: unscented transform or central differences (EQUATIONS 3).
class SigmaPoints {
 public:
  static constexpr bool kRefinesInBatch = false;
  struct Rules {
    SigmaRule motion;    ///< (pose, control noise): 5 dimensions if there are two controls
    SigmaRule pose;      ///< (pose, landmark): 5 dimensions
    SigmaRule landmark;  ///< a landmark, or (range, bearing): 2 dimensions
  };
  /// `new_landmarks` matters to initialise() alone.
  SigmaPoints(const Rules& rules, const Belief& belief, MapUncertainty map_uncertainty,
              NewLandmarks new_landmarks = NewLandmarks::corrected)
      : rules_(rules),
        map_uncertainty_(map_uncertainty),
        new_landmarks_(new_landmarks),
        ray_(direction_of(rules.landmark.spread * belief.sigma_bearing)) {}

  void advance(MotionIncrement& motion, const Control& control, double duration,
               const Belief& belief) const {
    motion = moved_by_sigma_points(motion, control, duration, belief, rules_.motion);
  }
  /// Updates a pose Gaussian with one detection by (3.2) with the moments of (7.1) (EQUATIONS 7,
  /// 8). The sigma points are those of the Gaussian after the previous detection. `matched` is the
  /// mask of the lanes that matched it.
  template <class Real, class Mask>
  [[gnu::always_inline]] Innovation<Real> refine(PoseGaussian<Real>& pose,
                                                 const LandmarkGaussian<Real>& landmark,
                                                 const Measurement<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Evidence<Real>& evidence) const {
    const LineOfSight<Real> s = line_of_sight(pose.mean, landmark.mean);
    const auto use = matched && is_usable(s);
    const SigmaObservation<Real> observation = sigma_observation_of(
        pose.covariance, landmark.covariance, s, seen, noise, rules_.pose, map_uncertainty_);
    Density<Real> density = condition(pose, observation.proposal, use);
    if (map_uncertainty_ == MapUncertainty::off) {
      density = {select(use, observation.whole.squared(), Real(0.0)),
                 select(use, observation.whole.S.determinant(), Real(1.0))};
    }
    evidence.add(density.squared, density.determinant, as_number<Real>(use),
                 as_number<Real>(matched));
    return observation.whole;
  }
  /// Updates a landmark with one detection from an exactly known pose (EQUATIONS 7, 8).
  template <class Real, class Mask, class Weighed>
  [[gnu::always_inline]] Innovation<Real> update(LandmarkGaussian<Real>& landmark,
                                                 const BasicPose<Real>& pose,
                                                 const Measurement<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Weighed& evidence) const {
    const LineOfSight<Real> s = line_of_sight(pose, landmark.mean);
    const auto use = matched && is_usable(s);
    const LandmarkObservation<Real> observation(landmark.covariance, s, seen, noise,
                                                rules_.landmark);
    const Innovation<Real>& v = observation.innovation;
    const Real determinant = v.S.determinant();
    const Real inverse = select(use, 1.0 / determinant, Real(0.0));
    const LandmarkGain<Real> K = observation.gain(inverse);
    const Real along = K.along_range * v.value.first + K.along_bearing * v.value.second;
    const Real across = K.across_range * v.value.first + K.across_bearing * v.value.second;
    landmark.mean = landmark.mean + in_map(along, across, s);
    landmark.covariance = select(use, turned_back(observation.after(K), s), landmark.covariance);
    evidence.add(v.S.adjugate_form(v.value.first, v.value.second) * inverse,
                 select(use, determinant, Real(1.0)), as_number<Real>(use),
                 as_number<Real>(matched));
    return v;
  }
  /// Initialises a landmark from an exactly known pose: the points z +- spread sqrt(R) e_i are sent
  /// through g(x, .) (EQUATIONS 8). The points of the range lie on the ray, those of the bearing at
  /// `ray_` to both sides of it.
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const Measurement<Real>& seen,
                                    const SensorNoise& noise) const {
    const SigmaRule& rule = rules_.landmark;
    const Direction<Real> d = direction_of(Real(pose.heading + seen.second));
    const Real odd = seen.first * ray_.sine, even = seen.first * (ray_.cosine - 1.0);
    const Real way = seen.first + rule.mean_weight * even;
    const Real along = noise.first + bend_weight(rule) * even * even;
    const Real across = rule.antisymmetric * odd * odd;
    LandmarkGaussian<Real> landmark{{pose.x + way * d.cosine, pose.y + way * d.sine},
                                    {along * d.cosine * d.cosine + across * d.sine * d.sine,
                                     (along - across) * d.cosine * d.sine,
                                     along * d.sine * d.sine + across * d.cosine * d.cosine}};
    if (new_landmarks_ == NewLandmarks::as_printed) {
      landmark.covariance.xx += noise.first;
      landmark.covariance.yy += noise.second;
    }
    return landmark;
  }

 protected:
  const Rules& rules() const { return rules_; }
  MapUncertainty map_uncertainty() const { return map_uncertainty_; }

 private:
  Rules rules_;
  MapUncertainty map_uncertainty_;
  NewLandmarks new_landmarks_;
  Direction<double> ray_;  ///< (cos, sin)(spread sigma_bearing)
};

}  // namespace montecarta::filters
