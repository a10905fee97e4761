// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/correlated_map.hpp"
#include "filters/moments/gaussian_draw.hpp"

namespace montecarta {

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

}  // namespace montecarta
