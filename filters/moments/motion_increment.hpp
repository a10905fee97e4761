// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/real.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/vehicle.hpp"
#include "filters/moments/gaussians.hpp"
#include "filters/moments/sigma_rule.hpp"
#include "filters/setup/filter_setup.hpp"

namespace montecarta::filters {

/// The motion since poses were last drawn, in the frame of the drawn pose. The vehicle does not
/// know where in the world it is, so this Gaussian is the same for every particle: it is predicted
/// once for all of them and turned to each particle's heading only when it is needed. Exact: equal
/// to one prediction per particle and step, by the extended Kalman filter (EQUATIONS 1: advance())
/// or by sigma points.
class MotionIncrement {
 public:
  MotionIncrement() = default;
  MotionIncrement(const Pose& pose, const Symmetric3<double>& covariance)
      : pose_(pose), covariance_(covariance) {}

  void restart() { *this = MotionIncrement(); }

  /// One control step of `duration` [s], linearised.
  void advance(const Control& control, double duration, const Belief& belief) {
    const auto sigma = deviations_of(belief.control, control, belief.vehicle);
    std::visit([&](const auto& one) { advance(one, control, duration, sigma); }, belief.vehicle);
  }

  const Pose& pose() const { return pose_; }
  const Symmetric3<double>& covariance() const { return covariance_; }

  /// What a particle that was at `origin` exactly believes now (EQUATIONS (1.6): P_i accumulates
  /// from zero).
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
               const std::array<double, Control::kMost>& sigma) {
    const double angle = bend_angle(vehicle, control, duration);
    const auto [heading, bend] = directions_of<2>({pose_.heading, angle});
    const auto [pose, F] =
        linearised_move(pose_, heading, control, {angle, bend}, duration, vehicle);
    covariance_ = sheared(covariance_, F.x_heading, F.y_heading);
    for (std::size_t i = 0; i < kControlsOf<V>; ++i) {
      const auto& [x, y, turn] = F.by_control[i];
      add_outer(covariance_, sigma[i] * sigma[i], {x, y, turn});
    }
    pose_ = pose;
  }

  Pose pose_;
  Symmetric3<double> covariance_;
};

/// One control step of `duration` [s] by sigma points of (pose, control noise) (EQUATIONS 3). The
/// square root has the heading first: its column alone bends, those of x and y are carried along
/// unchanged; of the controls the last one alone bends. Equal to sending all eleven points (of two
/// controls) through the vehicle.
MotionIncrement moved_by_sigma_points(const MotionIncrement& before, const Control& control,
                                      double duration, const Belief& belief, const SigmaRule& rule);

/// One control step of `duration` [s] whose noise is averaged instead of linearised: mean and
/// covariance of the vehicle's own displacement are exact in the controls that it is linear in, and
/// by Gauss-Hermite quadrature with three nodes in the last one. What a linearised step leaves out
/// is that a vehicle whose steering trembles gets less far, and that noise on the speed multiplies
/// noise on the steering. The heading it began with is carried along linearised.
MotionIncrement moved_by_quadrature(const MotionIncrement& before, const Control& control,
                                    double duration, const Belief& belief);

}  // namespace montecarta::filters
