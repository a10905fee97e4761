// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/linearised_sensor.hpp"

namespace montecarta::filters {

/// A sensor's observations of a landmark by sigma points (EQUATIONS 3, 7), in the frame of the
/// sensor, so that a turned world gives the turned estimate.
template <class Kind, class Real>
class SigmaSight {
 public:
  SigmaSight(const BasicPose<Real>& sensor, const BasicPoint<Real>& landmark, const SigmaRule& rule)
      : axes_(direction_of(sensor.heading)), rule_(rule) {
    const Real dx = landmark.x - sensor.x, dy = landmark.y - sensor.y;
    way_ = {axes_.cosine * dx + axes_.sine * dy, axes_.cosine * dy - axes_.sine * dx};
    centre_ = observed(Kind(), way_.x, way_.y);
  }

  /// A column (forward, left, turn) of the pose's square root: its images are added to `moments`;
  /// D is returned.
  [[gnu::always_inline]] RangeBearing<Real> add(const Column3<Real>& column,
                                                ObservationMoments<Real>& moments) const {
    const double spread = rule_.spread;
    const RangeBearing<Real> plus = from(spread * column.x, spread * column.y, spread * column.h);
    const RangeBearing<Real> minus =
        from(-spread * column.x, -spread * column.y, -spread * column.h);
    const ObservationPair<Real> pair{
        {0.5 * (plus.range - minus.range), 0.5 * (plus.bearing - minus.bearing)},
        {0.5 * (plus.range + minus.range), 0.5 * (plus.bearing + minus.bearing)}};
    moments.add(pair, rule_);
    return pair.odd;
  }
  /// Columns of a covariance in the map.
  std::array<Column3<Real>, 3> columns(const Symmetric3<Real>& P) const {
    const Cholesky3<Real> L(turned(P, Direction<Real>{axes_.cosine, -axes_.sine}));
    return {{{L.xx, L.yx, L.hx}, {Real(0.0), L.yy, L.hy}, {Real(0.0), Real(0.0), L.hh}}};
  }
  /// A column in the frame of the sensor, in the map.
  Column3<Real> in_map(const Column3<Real>& c) const {
    return {axes_.cosine * c.x - axes_.sine * c.y, axes_.sine * c.x + axes_.cosine * c.y, c.h};
  }
  /// Of `seen`, without cross-covariances.
  Innovation<Real> innovation(const RangeBearing<Real>& seen,
                              const ObservationMoments<Real>& moments) const {
    const RangeBearing<Real> mean{centre_.range + moments.shift.range,
                                  centre_.bearing + moments.shift.bearing};
    return {difference(Kind(), seen, mean), moments.covariance + outer(rule_.shift, moments.shift)};
  }
  /// Where the landmark is not too near.
  auto usable() const {
    return way_.x * way_.x + way_.y * way_.y > Real(kLeastDistance * kLeastDistance);
  }

 private:
  /// Observation less that of the centre, from a pose that is moved so in its own frame.
  RangeBearing<Real> from(const Real& forward, const Real& left, const Real& turn) const {
    const Direction<Real> d = direction_of(turn);
    const Real x = way_.x - forward, y = way_.y - left;
    return difference(
        Kind(), observed(Kind(), d.cosine * x + d.sine * y, d.cosine * y - d.sine * x), centre_);
  }

  Direction<Real> axes_;
  SigmaRule rule_;
  BasicPoint<Real> way_;  ///< to the landmark, forward and left
  RangeBearing<Real> centre_;
};

/// As `SigmaPoints`, of a sensor of another kind; poses are those of the sensor.
template <class Kind>
struct SigmaPointsOf : SigmaPoints {
  static_assert(!std::is_same_v<Kind, RangeBearingSensor>);
  explicit SigmaPointsOf(const SigmaPoints& points) : SigmaPoints(points) {}

  template <class Real, class Mask>
  Innovation<Real> refine(PoseGaussian<Real>& pose, const LandmarkGaussian<Real>& landmark,
                          const RangeBearing<Real>& seen, const SensorNoise& noise,
                          const Mask& matched, Evidence<Real>& evidence) const {
    const SigmaRule& rule = rules().pose;
    const SigmaSight<Kind, Real> s(pose.mean, landmark.mean, rule);
    ObservationMoments<Real> own{.covariance = {Real(noise.range), Real(0.0), Real(noise.bearing)}};
    Column3<Real> first{}, second{};
    for (const Column3<Real>& column : s.columns(pose.covariance)) {
      const RangeBearing<Real> D = s.add(column, own);
      first = first + Real(rule.antisymmetric * rule.spread * D.range) * column;
      second = second + Real(rule.antisymmetric * rule.spread * D.bearing) * column;
    }
    ObservationMoments<Real> both = own;
    for (const Column3<Real>& column : s.columns(in_plane(landmark.covariance)))
      s.add(column, both);
    Innovation<Real> whole = s.innovation(seen, both);
    Innovation<Real> proposal =
        map_uncertainty() == MapUncertainty::on ? whole : s.innovation(seen, own);
    proposal.range = s.in_map(first), proposal.bearing = s.in_map(second);
    const auto use = matched && s.usable();
    condition(pose, proposal, use);
    weigh(Kind(), density_of(whole, use), use, matched, evidence);
    return whole;
  }
  template <class Real, class Mask, class Weighed>
  Innovation<Real> update(LandmarkGaussian<Real>& landmark, const BasicPose<Real>& pose,
                          const RangeBearing<Real>& seen, const SensorNoise& noise,
                          const Mask& matched, Weighed& evidence) const {
    const SigmaRule& rule = rules().landmark;
    const SigmaSight<Kind, Real> s(pose, landmark.mean, rule);
    ObservationMoments<Real> moments{
        .covariance = {Real(noise.range), Real(0.0), Real(noise.bearing)}};
    Column3<Real> first{}, second{};
    for (const Column3<Real>& column : s.columns(in_plane(landmark.covariance))) {
      const RangeBearing<Real> D = s.add(column, moments);  // moves the other way than the pose
      first = first - Real(rule.antisymmetric * rule.spread * D.range) * column;
      second = second - Real(rule.antisymmetric * rule.spread * D.bearing) * column;
    }
    Innovation<Real> v = s.innovation(seen, moments);
    v.range = s.in_map(first), v.bearing = s.in_map(second);
    const auto use = matched && s.usable();
    weigh(Kind(), condition(landmark, v, use), use, matched, evidence);
    return v;
  }
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const RangeBearing<Real>& seen,
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

/// The transform of a sensor, given that of range and bearing.
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
