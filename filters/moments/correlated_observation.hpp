// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/correlated_map.hpp"
#include "filters/moments/linearised.hpp"

namespace montecarta::filters {

/// Rows of an observation's derivative by the landmark's place; by the pose's place they are the
/// negatives, by the heading 0 and -1.
template <class Real>
struct ObservationRows {
  Real range_x, range_y, bearing_x, bearing_y;

  [[gnu::always_inline]] explicit ObservationRows(const LineOfSight<Real>& s)
      : range_x(s.ux),
        range_y(s.uy),
        bearing_x(-(s.per_range * s.uy)),
        bearing_y(s.per_range * s.ux) {}

  /// Covariance with (range, bearing) of a number whose covariance with the relative place and with
  /// the heading is given.
  [[gnu::always_inline]] RangeBearing<Real> of(const Real& x, const Real& y,
                                               const Real& heading) const {
    return {range_x * x + range_y * y, bearing_x * x + bearing_y * y - heading};
  }
};

/// What an observation says of a pose Gaussian that is correlated with the landmark by C.
template <class Real>
[[gnu::always_inline]] inline Innovation<Real> correlated_innovation(
    const Symmetric3<Real>& P, const Symmetric2<Real>& F, const PoseCross<Real>& C,
    const ObservationRows<Real>& rows, const RangeBearing<Real>& value, const SensorNoise& noise) {
  const RangeBearing<Real> x = rows.of(C.x.x - P.xx, C.y.x - P.xy, P.xh);
  const RangeBearing<Real> y = rows.of(C.x.y - P.xy, C.y.y - P.yy, P.yh);
  const RangeBearing<Real> h = rows.of(C.x.h - P.xh, C.y.h - P.yh, P.hh);
  const RangeBearing<Real> fx = rows.of(F.xx - C.x.x, F.xy - C.x.y, C.x.h);
  const RangeBearing<Real> fy = rows.of(F.xy - C.y.x, F.yy - C.y.y, C.y.h);
  const Real dx_r = fx.range - x.range, dy_r = fy.range - y.range;
  const Real dx_b = fx.bearing - x.bearing, dy_b = fy.bearing - y.bearing;
  return {value,
          {noise.range + rows.range_x * dx_r + rows.range_y * dy_r,
           rows.range_x * dx_b + rows.range_y * dy_b,
           noise.bearing + rows.bearing_x * dx_b + rows.bearing_y * dy_b - h.bearing},
          {x.range, y.range, h.range},
          {x.bearing, y.bearing, h.bearing}};
}

/// Turns covariances with an innovation into white gains.
template <class Real>
struct Whitening {
  Real slope, first, second;  ///< of bearing by range; 1 / standard deviations

  [[gnu::always_inline]] explicit Whitening(const Decorrelated<Real>& d)
      : slope(d.slope), first(sqrt(d.per_rr)), second(sqrt(d.per_bb)) {}
  [[gnu::always_inline]] WhiteGain<Real> operator()(const Real& range, const Real& bearing) const {
    return {range * first, (bearing - slope * range) * second};
  }
};

template <class Real>
[[gnu::always_inline]] inline Real operator*(const WhiteGain<Real>& a, const WhiteGain<Real>& b) {
  return a.first * b.first + a.second * b.second;
}

/// mean <- mean + W value, P <- P - W W' for what is not of the pose alone; the gains of landmarks
/// are in `maps`.
template <class Real>
void apply_gains(CorrelatedMap<Real>& maps, std::size_t b, const WhiteGain<Real>& value,
                 const WhiteGain<Real>& x, const WhiteGain<Real>& y, const WhiteGain<Real>& h) {
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const MapGain<Real> g = maps.gain(i, b);
    PoseCross<Real>& C = maps.pose_cross(i, b);
    C = {{C.x.x - g.x * x, C.x.y - g.x * y, C.x.h - g.x * h},
         {C.y.x - g.y * x, C.y.y - g.y * y, C.y.h - g.y * h}};
    change(maps.landmark(i, b), {g.x * value, g.y * value}, {g.x * g.x, g.x * g.y, g.y * g.y});
    for (std::size_t j = 0; j < i; ++j) {
      const MapGain<Real>& w = maps.gain(j, b);
      MapCross<Real>& B = maps.map_cross(i, j, b);
      B = {B.xx - g.x * w.x, B.xy - g.x * w.y, B.yx - g.y * w.x, B.yy - g.y * w.y};
    }
  }
}

/// Updates pose and map of block b with a detection of landmark `at`: the update of EKF-SLAM
/// (EQUATIONS 15). `matched`: which lanes saw it.
template <class Real, class Where, class Mask>
Innovation<Real> update_with(CorrelatedMap<Real>& maps, std::size_t b, const Where& at,
                             const RangeBearing<Real>& seen, const SensorNoise& noise,
                             const Mask& matched, Evidence<Real>& evidence) {
  PoseGaussian<Real>& pose = maps.pose(b);
  const LandmarkGaussian<Real> f = maps.landmark(at, b);
  const LineOfSight<Real> s = line_of_sight(pose.mean, f.mean);
  const auto use = matched && is_usable(s);
  const ObservationRows<Real> rows(s);
  Innovation<Real> v =
      correlated_innovation(pose.covariance, f.covariance, PoseCross<Real>(maps.pose_cross(at, b)),
                            rows, residual(seen, s), noise);
  const Decorrelated<Real> d(v, use);
  const Whitening<Real> white(d);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const PoseCross<Real>& with_pose = maps.pose_cross(i, b);
    const MapCross<Real> V = maps.covariance(i, at, b);
    const RangeBearing<Real> x = rows.of(V.xx - with_pose.x.x, V.xy - with_pose.x.y, with_pose.x.h);
    const RangeBearing<Real> y = rows.of(V.yx - with_pose.y.x, V.yy - with_pose.y.y, with_pose.y.h);
    maps.gain(i, b) = {white(x.range, x.bearing), white(y.range, y.bearing)};
  }
  apply_gains(maps, b, {d.first * white.first, d.second * white.second},
              white(v.range.x, v.bearing.x), white(v.range.y, v.bearing.y),
              white(v.range.h, v.bearing.h));
  condition(pose, v, use);
  pose.mean.heading = wrap(pose.mean.heading);
  evidence.add(d.density.squared, d.density.determinant, as_number<Real>(use),
               as_number<Real>(matched));
  return v;
}

}  // namespace montecarta::filters
