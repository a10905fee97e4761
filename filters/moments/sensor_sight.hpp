// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "filters/models/sensor_kinds.hpp"
#include "filters/moments/linearised.hpp"
#include "filters/moments/sigma_points.hpp"

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
  Real distance;                ///< [m]
};

/// The components that a sensor measures of a point in its own frame.
template <class Real>
[[gnu::always_inline]] inline Measurement<Real> observed(PositionSensor, const Real& forward,
                                                         const Real& left) {
  return {forward, left};
}
template <class Real>
[[gnu::always_inline]] inline Measurement<Real> observed(BearingSensor, const Real& forward,
                                                         const Real& left) {
  return {atan2(left, forward), Real(0.0)};
}
template <class Real>
[[gnu::always_inline]] inline Measurement<Real> observed(RangeSensor, const Real& forward,
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

/// Predicts the detection of a landmark by sigma points (EQUATIONS 3, 7) in the frame of the
/// sensor, so that a rotated world gives the rotated estimate.
template <class Kind, class Real>
class SigmaSight {
 public:
  SigmaSight(const BasicPose<Real>& sensor, const BasicPoint<Real>& landmark, const SigmaRule& rule)
      : axes_(direction_of(sensor.heading)), rule_(rule) {
    const Real dx = landmark.x - sensor.x, dy = landmark.y - sensor.y;
    way_ = {axes_.cosine * dx + axes_.sine * dy, axes_.cosine * dy - axes_.sine * dx};
    centre_ = observed(Kind(), way_.x, way_.y);
  }

  /// Adds to `moments` the images of the points along a column (forward, left, turn) of the square
  /// root of the pose; returns D.
  [[gnu::always_inline]] Measurement<Real> add(const Column3<Real>& column,
                                               ObservationMoments<Real>& moments) const {
    const double spread = rule_.spread;
    const Measurement<Real> plus = from(spread * column.x, spread * column.y, spread * column.h);
    const Measurement<Real> minus =
        from(-spread * column.x, -spread * column.y, -spread * column.h);
    const ObservationPair<Real> pair{
        {0.5 * (plus.first - minus.first), 0.5 * (plus.second - minus.second)},
        {0.5 * (plus.first + minus.first), 0.5 * (plus.second + minus.second)}};
    moments.add(pair, rule_);
    return pair.odd;
  }
  /// Columns, in the frame of the sensor, of the square root of a covariance given in the map.
  std::array<Column3<Real>, 3> columns(const Symmetric3<Real>& P) const {
    const Cholesky3<Real> L(turned(P, Direction<Real>{axes_.cosine, -axes_.sine}));
    return {{{L.xx, L.yx, L.hx}, {Real(0.0), L.yy, L.hy}, {Real(0.0), Real(0.0), L.hh}}};
  }
  /// Rotates a column from the frame of the sensor into the map.
  Column3<Real> in_map(const Column3<Real>& c) const {
    return {axes_.cosine * c.x - axes_.sine * c.y, axes_.sine * c.x + axes_.cosine * c.y, c.h};
  }
  /// Innovation of `seen`, without cross-covariances.
  Innovation<Real> innovation(const Measurement<Real>& seen,
                              const ObservationMoments<Real>& moments) const {
    const Measurement<Real> mean{centre_.first + moments.shift.first,
                                 centre_.second + moments.shift.second};
    return {difference(Kind(), seen, mean), moments.covariance + outer(rule_.shift, moments.shift)};
  }
  /// Mask of the lanes in which the landmark is not too near.
  auto usable() const {
    return way_.x * way_.x + way_.y * way_.y > Real(kLeastDistance * kLeastDistance);
  }

 private:
  /// The observation from a pose displaced in its own frame, minus that of the centre.
  Measurement<Real> from(const Real& forward, const Real& left, const Real& turn) const {
    const Direction<Real> d = direction_of(turn);
    const Real x = way_.x - forward, y = way_.y - left;
    return difference(
        Kind(), observed(Kind(), d.cosine * x + d.sine * y, d.cosine * y - d.sine * x), centre_);
  }

  Direction<Real> axes_;
  SigmaRule rule_;
  BasicPoint<Real> way_;  ///< vector to the landmark (forward, left)
  Measurement<Real> centre_;
};

/// `SigmaPoints` for a sensor of another kind; poses are those of the sensor.
template <class Kind>
struct SigmaPointsOf : SigmaPoints {
  static_assert(!std::is_same_v<Kind, RangeBearingSensor>);
  explicit SigmaPointsOf(const SigmaPoints& points) : SigmaPoints(points) {}

  template <class Real, class Mask>
  Innovation<Real> refine(PoseGaussian<Real>& pose, const LandmarkGaussian<Real>& landmark,
                          const Measurement<Real>& seen, const SensorNoise& noise,
                          const Mask& matched, Evidence<Real>& evidence) const {
    const SigmaRule& rule = rules().pose;
    const SigmaSight<Kind, Real> s(pose.mean, landmark.mean, rule);
    ObservationMoments<Real> own{.covariance = {Real(noise.first), Real(0.0), Real(noise.second)}};
    Column3<Real> first{}, second{};
    for (const Column3<Real>& column : s.columns(pose.covariance)) {
      const Measurement<Real> D = s.add(column, own);
      first = first + Real(rule.antisymmetric * rule.spread * D.first) * column;
      second = second + Real(rule.antisymmetric * rule.spread * D.second) * column;
    }
    ObservationMoments<Real> both = own;
    for (const Column3<Real>& column : s.columns(in_plane(landmark.covariance)))
      s.add(column, both);
    Innovation<Real> whole = s.innovation(seen, both);
    Innovation<Real> proposal =
        map_uncertainty() == MapUncertainty::on ? whole : s.innovation(seen, own);
    proposal.first = s.in_map(first), proposal.second = s.in_map(second);
    const auto use = matched && s.usable();
    condition(pose, proposal, use);
    weigh(Kind(), density_of(whole, use), use, matched, evidence);
    return whole;
  }
  template <class Real, class Mask, class Weighed>
  Innovation<Real> update(LandmarkGaussian<Real>& landmark, const BasicPose<Real>& pose,
                          const Measurement<Real>& seen, const SensorNoise& noise,
                          const Mask& matched, Weighed& evidence) const {
    const SigmaRule& rule = rules().landmark;
    const SigmaSight<Kind, Real> s(pose, landmark.mean, rule);
    ObservationMoments<Real> moments{
        .covariance = {Real(noise.first), Real(0.0), Real(noise.second)}};
    Column3<Real> first{}, second{};
    for (const Column3<Real>& column : s.columns(in_plane(landmark.covariance))) {
      const Measurement<Real> D = s.add(column, moments);  // a landmark moves opposite to the pose
      first = first - Real(rule.antisymmetric * rule.spread * D.first) * column;
      second = second - Real(rule.antisymmetric * rule.spread * D.second) * column;
    }
    Innovation<Real> v = s.innovation(seen, moments);
    v.first = s.in_map(first), v.second = s.in_map(second);
    const auto use = matched && s.usable();
    weigh(Kind(), condition(landmark, v, use), use, matched, evidence);
    return v;
  }
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const Measurement<Real>& seen,
                                    const SensorNoise& noise) const {
    return placed_landmark(Kind(), pose, seen, noise);
  }

 private:
  template <class Real>
  static Symmetric3<Real> in_plane(const Symmetric2<Real>& P) {
    return {P.xx, P.xy, P.yy, Real(0.0), Real(0.0), Real(0.0)};
  }
  template <class Real, class Mask>
  static Density<Real> density_of(const Innovation<Real>& v, const Mask& use) {
    return {select(use, v.squared(), Real(0.0)), select(use, v.S.determinant(), Real(1.0))};
  }
};

/// Converts a transform for range and bearing to that for a sensor of another kind.
template <class Kind>
LinearisedSensor<Kind> of_kind(Kind, const Linearised& /*transform*/) {
  return {};
}
template <class Kind>
SigmaPointsOf<Kind> of_kind(Kind, const SigmaPoints& transform) {
  return SigmaPointsOf<Kind>(transform);
}
inline SigmaPoints of_kind(RangeBearingSensor, const SigmaPoints& transform) { return transform; }

}  // namespace montecarta::filters
