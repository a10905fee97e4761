// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_belief.hpp"

// Where a JointBelief linearises, and what its linearised system tells of what none can observe.

namespace montecarta::filters {
namespace {

bool stands_still(const MotionIncrement& motion) {
  const Pose& pose = motion.pose();
  return pose.x == 0.0 && pose.y == 0.0 && pose.heading == 0.0 &&
         symmetric(motion.covariance()).isZero(0.0);
}

}  // namespace

Eigen::Vector2d JointBelief::shift_of_points() const {
  if (linearisation_ != Linearisation::constrained) return Eigen::Vector2d::Zero();
  return points_.shift_to(gaussian_);
}

/// A vehicle that has not moved keeps its point, and nothing is linearised.
LinearisedMotion JointBelief::linearised(const MotionIncrement& motion) const {
  if (regresses()) return gaussian_.regressed(motion);
  LinearisedMotion linearised = gaussian_.linearised(motion);
  if (!has_own_points() || stands_still(motion)) return linearised;
  linearised.by_heading +=
      quarter_turned(points_.behind(gaussian_.pose().mean) - shift_of_points());
  return linearised;
}

void JointBelief::move(const MotionIncrement& motion) {
  const LinearisedMotion how = linearised(motion);
  if (linearisation_ == Linearisation::constrained && !stands_still(motion))
    points_.shift(shift_of_points());
  gaussian_.move(how);
  points_.move(how);
}

std::optional<ObservationPoint> JointBelief::observation_point(std::size_t slot) const {
  if (!has_own_points()) return std::nullopt;
  return ObservationPoint{points_.pose(), points_.landmark(slot)};
}

/// The invariant error's turn is about the estimate, to which it is carried after every detection;
/// of errors relative to the vehicle a turn of the whole turns the frame of the map alone.
ObservationPoint JointBelief::rotation_point(std::size_t slot) const {
  if (retraction_ == Retraction::invariant || is_robocentric() || !fixes_landmark(sensor_))
    return {gaussian_.pose().mean, gaussian_.mean_of(slot)};
  return {points_.pose(), points_.landmark(slot)};
}

}  // namespace montecarta::filters
