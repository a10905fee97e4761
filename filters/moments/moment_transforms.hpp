// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/linearised.hpp"
#include "filters/moments/motion_increment.hpp"
#include "filters/moments/sigma_landmark.hpp"
#include "filters/moments/sigma_pose.hpp"

/// The ways to carry a Gaussian through motion and observation. Filters of the family differ in
/// which of them moves the pose and which keeps the map.
namespace montecarta::filters {

/// The extended Kalman filter (EQUATIONS 3).
struct Linearised {
  static constexpr bool kRefinesInBatch = true;
  void advance(MotionIncrement& motion, const Control& control, double duration,
               const Belief& belief) const {
    motion.advance(control, duration, belief);
  }
  template <class Real, class Mask>
  [[gnu::always_inline]] Innovation<Real> refine(PoseGaussian<Real>& pose,
                                                 const LandmarkGaussian<Real>& landmark,
                                                 const RangeBearing<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Evidence<Real>& evidence) const {
    return refine_pose(pose, landmark, seen, noise, matched, evidence);
  }
  template <class Real, class Mask>
  void refine_in_batch(PoseGaussian<Real>& pose, const BasicPose<Real>& predicted,
                       const LandmarkGaussian<Real>& landmark, const RangeBearing<Real>& seen,
                       const SensorNoise& noise, const Mask& matched,
                       Evidence<Real>& evidence) const {
    refine_pose_in_batch(pose, predicted, landmark, seen, noise, matched, evidence);
  }
  template <class Real, class Mask, class Weighed>
  [[gnu::always_inline]] Innovation<Real> update(LandmarkGaussian<Real>& landmark,
                                                 const BasicPose<Real>& pose,
                                                 const RangeBearing<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Weighed& evidence) const {
    return update_landmark(landmark, pose, seen, noise, matched, evidence);
  }
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const RangeBearing<Real>& seen,
                                    const SensorNoise& noise) const {
    return new_landmark(pose, seen, noise);
  }
};

/// Sigma points: unscented or central differences (EQUATIONS 3), by their rules.
class SigmaPoints {
 public:
  static constexpr bool kRefinesInBatch = false;
  struct Rules {
    SigmaRule motion;    ///< of (pose, control noise): 5 dimensions of two controls
    SigmaRule pose;      ///< of (pose, landmark): 5
    SigmaRule landmark;  ///< of a landmark, or of (range, bearing): 2
  };
  SigmaPoints(const Rules& rules, const Belief& belief, MapUncertainty map_uncertainty)
      : rules_(rules),
        map_uncertainty_(map_uncertainty),
        ray_(direction_of(rules.landmark.spread * belief.sigma_bearing)) {}

  void advance(MotionIncrement& motion, const Control& control, double duration,
               const Belief& belief) const {
    motion = moved_by_sigma_points(motion, control, duration, belief, rules_.motion);
  }
  template <class Real, class Mask>
  [[gnu::always_inline]] Innovation<Real> refine(PoseGaussian<Real>& pose,
                                                 const LandmarkGaussian<Real>& landmark,
                                                 const RangeBearing<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Evidence<Real>& evidence) const {
    return refine_pose_by_sigma_points(pose, landmark, seen, noise, matched, evidence, rules_.pose,
                                       map_uncertainty_);
  }
  template <class Real, class Mask, class Weighed>
  [[gnu::always_inline]] Innovation<Real> update(LandmarkGaussian<Real>& landmark,
                                                 const BasicPose<Real>& pose,
                                                 const RangeBearing<Real>& seen,
                                                 const SensorNoise& noise, const Mask& matched,
                                                 Weighed& evidence) const {
    return update_landmark_by_sigma_points(landmark, pose, seen, noise, matched, evidence,
                                           rules_.landmark);
  }
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const RangeBearing<Real>& seen,
                                    const SensorNoise& noise) const {
    return new_landmark_by_sigma_points(pose, seen, noise, rules_.landmark, ray_);
  }

 protected:
  const Rules& rules() const { return rules_; }
  MapUncertainty map_uncertainty() const { return map_uncertainty_; }

 private:
  Rules rules_;
  MapUncertainty map_uncertainty_;
  Direction<double> ray_;  ///< of a new landmark's outer points, from the line of sight
};

}  // namespace montecarta::filters
