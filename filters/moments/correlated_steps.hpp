// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/correlated_map.hpp"
#include "filters/moments/gaussian_draw.hpp"
#include "filters/moments/motion_increment.hpp"

// How a CorrelatedMap moves, meets a new landmark, and is given the pose that was drawn.

namespace montecarta::filters {

/// A pose that is itself uncertain, driven on, and what its heading did to its place: x and y
/// change by `lever` times an error of the heading.
template <class Real>
struct PredictedPose {
  PoseGaussian<Real> pose;
  BasicPoint<Real> lever;  ///< [m/rad]
};

/// Fx P Fx' with the motion's own covariance turned into the map (EQUATIONS 1). Of several steps Fx
/// is again [1 0 a; 0 1 b; 0 0 1], so one increment stands for all since the last scan.
template <class Real>
PredictedPose<Real> predicted_pose(const PoseGaussian<Real>& before,
                                   const MotionIncrement& motion) {
  const auto& [mean, P] = before;
  const Direction<Real> d = direction_of(mean.heading);
  const Pose& step = motion.pose();
  const Real way_x = d.cosine * step.x - d.sine * step.y;
  const Real way_y = d.sine * step.x + d.cosine * step.y;
  return {{{mean.x + way_x, mean.y + way_y, wrap(Real(mean.heading + step.heading))},
           sheared(P, Real(-way_y), way_x) + turned(in_every_lane<Real>(motion.covariance()), d)},
          {-way_y, way_x}};
}

/// Drives block b on, map included.
template <class Real>
void predict_with_map(CorrelatedMap<Real>& maps, std::size_t b, const MotionIncrement& motion) {
  const PredictedPose<Real> now = predicted_pose(maps.pose(b), motion);
  maps.pose(b) = now.pose;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    auto& [x, y] = maps.pose_cross(i, b);
    x.x += now.lever.x * x.h;
    x.y += now.lever.y * x.h;
    y.x += now.lever.x * y.h;
    y.y += now.lever.y * y.h;
  }
}

/// A landmark seen for the first time from an uncertain pose, with all it is correlated with:
/// g(x, z), Gx P Gx' + Gz R Gz' and Gx P (EQUATIONS 15).
template <class Real>
struct NewLandmark {
  LandmarkGaussian<Real> landmark;
  PoseCross<Real> pose_cross;
  BasicPoint<Real> lever;  ///< what an error of the heading adds to it [m/rad]

  /// Its covariance with another landmark, this one's rows.
  MapCross<Real> with(const PoseCross<Real>& other) const {
    return {other.x.x + lever.x * other.x.h, other.y.x + lever.x * other.y.h,
            other.x.y + lever.y * other.x.h, other.y.y + lever.y * other.y.h};
  }
};

template <class Real>
NewLandmark<Real> new_correlated_landmark(const PoseGaussian<Real>& pose,
                                          const RangeBearing<Real>& seen,
                                          const SensorNoise& noise) {
  const auto& [mean, P] = pose;
  const Direction<Real> ray = direction_of(Real(mean.heading + seen.bearing));
  const Real a = -(seen.range * ray.sine), b = seen.range * ray.cosine;
  const PoseCross<Real> C{{P.xx + a * P.xh, P.xy + a * P.yh, P.xh + a * P.hh},
                          {P.xy + b * P.xh, P.yy + b * P.yh, P.yh + b * P.hh}};
  const Real across = noise.bearing, along = noise.range;
  return {{{mean.x + seen.range * ray.cosine, mean.y + seen.range * ray.sine},
           {C.x.x + a * C.x.h + a * a * across + ray.cosine * ray.cosine * along,
            C.x.y + b * C.x.h + a * b * across + ray.cosine * ray.sine * along,
            C.y.y + b * C.y.h + b * b * across + ray.sine * ray.sine * along}},
          C,
          {a, b}};
}

/// Makes landmark i of block b the new one; `put(from, to)` writes the lanes that are meant.
template <class Real, class Put>
void place(CorrelatedMap<Real>& maps, std::size_t b, std::size_t i,
           const NewLandmark<Real>& initialised, const Put& put) {
  for (std::size_t j = 0; j < maps.size(); ++j) {
    if (j == i) continue;
    const MapCross<Real> c = initialised.with(maps.pose_cross(j, b));
    if (j < i) {
      put(c, maps.map_cross(i, j, b));
    } else {
      put(MapCross<Real>{c.xx, c.yx, c.xy, c.yy}, maps.map_cross(j, i, b));
    }
  }
  put(initialised.landmark, maps.landmark(i, b));
  put(initialised.pose_cross, maps.pose_cross(i, b));
}

/// What it means for a landmark that the pose it is correlated with turns out to be `drawn`:
/// f + P_fx P^-1 (drawn - mean), P_ff - P_fx P^-1 P_xf. P is factored in the frame of the vehicle;
/// a direction in which the pose is certain tells nothing.
template <class Real>
class KnownPose {
 public:
  KnownPose(const PoseGaussian<Real>& pose, const BasicPose<Real>& drawn)
      : factor_(pose),
        per_xx_(reciprocal(factor_.L.xx)),
        per_yy_(reciprocal(factor_.L.yy)),
        per_hh_(reciprocal(factor_.L.hh)),
        value_(white({drawn.x - pose.mean.x, drawn.y - pose.mean.y,
                      shorter_way(Real(drawn.heading - pose.mean.heading))})) {}

  LandmarkGaussian<Real> condition(LandmarkGaussian<Real> landmark,
                                   const PoseCross<Real>& cross) const {
    const Column3<Real> x = white(cross.x), y = white(cross.y);
    change(landmark, {dot(x, value_), dot(y, value_)}, {dot(x, x), dot(x, y), dot(y, y)});
    return landmark;
  }
  const Real& faults() const { return factor_.L.faults; }

 private:
  static Real reciprocal(const Real& root) {
    return select(root > Real(0.0), 1.0 / root, Real(0.0));
  }
  static Real dot(const Column3<Real>& a, const Column3<Real>& b) {
    return a.x * b.x + a.y * b.y + a.h * b.h;
  }
  /// L^-1 of a column given in the map frame.
  Column3<Real> white(const Column3<Real>& column) const {
    const auto& [c, s] = factor_.ahead;
    const Cholesky3<Real>& L = factor_.L;
    const Real x = (c * column.x + s * column.y) * per_xx_;
    const Real y = (c * column.y - s * column.x - L.yx * x) * per_yy_;
    return {x, y, (column.h - L.hx * x - L.hy * y) * per_hh_};
  }

  PoseFactor<Real> factor_;
  Real per_xx_, per_yy_, per_hh_;
  Column3<Real> value_;
};

}  // namespace montecarta::filters
