// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/sensor_sight.hpp"
#include "filters/moments/sigma_points.hpp"

/// Detections of a sensor of any kind, predicted by sigma points at the pose of the sensor.
namespace montecarta::filters {

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
  /// Adds the points along all columns of the square root of P; returns the cross-covariances of P
  /// with the two components, in the map.
  std::array<Column3<Real>, 2> add_points(const Symmetric3<Real>& P,
                                          ObservationMoments<Real>& moments) const {
    Column3<Real> first{}, second{};
    for (const Column3<Real>& column : columns(P)) {
      const Measurement<Real> D = add(column, moments);
      first = first + Real(rule_.antisymmetric * rule_.spread * D.first) * column;
      second = second + Real(rule_.antisymmetric * rule_.spread * D.second) * column;
    }
    return {in_map(first), in_map(second)};
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
  /// Returns the observation from a pose displaced in its own frame, minus that of the centre.
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
    const SigmaSight<Kind, Real> s(pose.mean, landmark.mean, rules().pose);
    ObservationMoments<Real> own{.covariance = {Real(noise.first), Real(0.0), Real(noise.second)}};
    const auto [first, second] = s.add_points(pose.covariance, own);
    ObservationMoments<Real> both = own;
    s.add_points(in_plane(landmark.covariance), both);
    Innovation<Real> whole = s.innovation(seen, both);
    Innovation<Real> proposal =
        map_uncertainty() == MapUncertainty::on ? whole : s.innovation(seen, own);
    proposal.first = first, proposal.second = second;
    const auto use = matched && s.usable();
    condition(pose, proposal, use);
    weigh(Kind(), density_of(whole, use), use, matched, evidence);
    return whole;
  }
  template <class Real, class Mask, class Weighed>
  Innovation<Real> update(LandmarkGaussian<Real>& landmark, const BasicPose<Real>& pose,
                          const Measurement<Real>& seen, const SensorNoise& noise,
                          const Mask& matched, Weighed& evidence) const {
    const SigmaSight<Kind, Real> s(pose, landmark.mean, rules().landmark);
    ObservationMoments<Real> moments{
        .covariance = {Real(noise.first), Real(0.0), Real(noise.second)}};
    const auto [first, second] = s.add_points(in_plane(landmark.covariance), moments);
    Innovation<Real> v = s.innovation(seen, moments);
    // The landmark moves opposite to the pose.
    v.first = Column3<Real>{} - first, v.second = Column3<Real>{} - second;
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
SigmaPointsOf<Kind> of_kind(Kind, const SigmaPoints& transform) {
  return SigmaPointsOf<Kind>(transform);
}
inline SigmaPoints of_kind(RangeBearingSensor, const SigmaPoints& transform) { return transform; }

}  // namespace montecarta::filters
