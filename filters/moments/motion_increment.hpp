// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/gaussians.hpp"
#include "filters/setup/filter_setup.hpp"

#include <array>

namespace montecarta::filters {

/// The motion since the poses were last drawn, in the frame of the drawn pose. It does not depend
/// on where in the world the vehicle is, so this Gaussian is the same for every particle: it is
/// predicted once for all of them and rotated to the heading of a particle only when needed. This
/// is exact: it equals one prediction per particle and step by the extended Kalman filter
/// (advance(), EQUATIONS 1) or by sigma points.
class MotionIncrement {
 public:
  MotionIncrement() = default;
  MotionIncrement(const Pose& pose, const Symmetric3<double>& covariance)
      : pose_(pose), covariance_(covariance) {}

  void restart() { *this = MotionIncrement(); }

  /// Adds the noise of a step, besides that of its controls, that began with the direction `course`
  /// (EQUATIONS (1.11), (1.12)).
  void add_increment_noise(const Direction<double>& course, const Control& control, double duration,
                           const Belief& belief);
  /// Adds one control step of `duration` [s], linearised.
  void advance(const Control& control, double duration, const Belief& belief);

  const Pose& pose() const { return pose_; }
  const Symmetric3<double>& covariance() const { return covariance_; }

  /// The predicted Gaussian of a particle that was drawn at `origin` (EQUATIONS (1.6)).
  template <class Real>
  [[gnu::always_inline]] PoseGaussian<Real> from(const BasicPose<Real>& origin) const {
    const Direction<Real> d = direction_of(origin.heading);
    return {
        {origin.x + d.cosine * pose_.x - d.sine * pose_.y,
         origin.y + d.sine * pose_.x + d.cosine * pose_.y, wrap(origin.heading + pose_.heading)},
        turned(in_every_lane<Real>(covariance_), d)};
  }

 private:
  template <class V>
  void advance(const V& vehicle, const Control& control, double duration,
               const std::array<double, Control::kMost>& sigma);

  Pose pose_;
  Symmetric3<double> covariance_;
};

}  // namespace montecarta::filters
