// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "engine/numbers/angle.hpp"

#include <Eigen/Core>

#include <utility>

namespace montecarta::filters {

/// From one component's mean to another's.
inline Eigen::VectorXd way_to(const JointEstimate& to, const JointEstimate& from) {
  Eigen::VectorXd way = to.mean - from.mean;
  way(2) = wrap(way(2));
  return way;
}
inline Eigen::Vector2d way_to(const LandmarkEstimate& to, const LandmarkEstimate& from) {
  return to.mean - from.mean;
}
inline Eigen::Vector3d way_to(const PoseMoments& to, const PoseMoments& from) {
  return boxminus(to.mean, from.mean);
}

/// Moves a component's mean along such a way.
inline void move_along(JointEstimate& joint, const Eigen::VectorXd& way) {
  joint.mean += way;
  joint.mean(2) = wrap(joint.mean(2));
}
inline void move_along(LandmarkEstimate& landmark, const Eigen::Vector2d& way) {
  landmark.mean += way;
}
inline void move_along(PoseMoments& pose, const Eigen::Vector3d& way) {
  pose.mean = {pose.mean.x + way(0), pose.mean.y + way(1), wrap(pose.mean.heading + way(2))};
}

/// Adds up Gaussians to the mean and covariance of their mixture (EQUATIONS 19), as differences
/// from one of them: components that are all equal give exactly their own moments, whatever their
/// weights are rounded to. Headings are taken the shorter way from that one. NaN of landmarks never
/// seen stays NaN. `Gaussian`: PoseMoments, JointEstimate or LandmarkEstimate.
template <class Gaussian>
class Mixture {
 public:
  explicit Mixture(const Gaussian& about)
      : about_(about),
        shift_(Vector::Zero(about.covariance.rows())),
        change_(Matrix::Zero(about.covariance.rows(), about.covariance.cols())) {}

  /// A component of weight `weight`; the weights of all are to add up to one. The one it is about
  /// needs not be added.
  void add(double weight, const Gaussian& component) {
    const Vector away = way_to(component, about_);
    shift_ += weight * away;
    change_ += weight * (component.covariance - about_.covariance + away * away.transpose());
  }
  Gaussian result() const {
    Gaussian whole = about_;
    move_along(whole, shift_);
    whole.covariance += change_ - shift_ * shift_.transpose();
    return whole;
  }

 private:
  using Vector = decltype(way_to(std::declval<Gaussian>(), std::declval<Gaussian>()));
  using Matrix = decltype(Gaussian::covariance);

  Gaussian about_;
  Vector shift_;
  Matrix change_;
};

}  // namespace montecarta::filters
