// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/angle.hpp"
#include "engine/runs/slam_filter.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace montecarta {

/// From one component's mean to another's.
inline Eigen::VectorXd way_to(const JointEstimate& to, const JointEstimate& from) {
  Eigen::VectorXd way = to.mean - from.mean;
  way(2) = wrap(way(2));
  return way;
}
inline Eigen::Vector2d way_to(const LandmarkEstimate& to, const LandmarkEstimate& from) {
  return to.mean - from.mean;
}

inline JointEstimate wrapped(JointEstimate joint) {
  joint.mean(2) = wrap(joint.mean(2));
  return joint;
}
inline LandmarkEstimate wrapped(const LandmarkEstimate& landmark) { return landmark; }

/// Adds up Gaussians to the mean and covariance of their mixture, as differences from one of them:
/// components that are all equal give exactly their own moments, whatever their weights are rounded
/// to. NaN of landmarks never seen stays NaN. `Gaussian`: JointEstimate or LandmarkEstimate.
template <class Gaussian>
class Mixture {
 public:
  explicit Mixture(const Gaussian& about)
      : about_(about),
        shift_(Vector::Zero(about.mean.size())),
        change_(Matrix::Zero(about.mean.size(), about.mean.size())) {}

  /// A component of weight `weight`; the weights of all are to add up to one. The one it is about
  /// needs not be added.
  void add(double weight, const Gaussian& component) {
    const auto away = way_to(component, about_);
    shift_ += weight * away;
    change_ += weight * (component.covariance - about_.covariance + away * away.transpose());
  }
  Gaussian result() const {
    return wrapped(
        Gaussian{about_.mean + shift_, about_.covariance + change_ - shift_ * shift_.transpose()});
  }

 private:
  using Vector = decltype(Gaussian::mean);
  using Matrix = decltype(Gaussian::covariance);

  Gaussian about_;
  Vector shift_;
  Matrix change_;
};

/// Mean and covariance of a mixture of Gaussians over the pose (SPEC 19), as differences from one
/// component `of(reference)`: components that are all equal give exactly their own moments,
/// whatever their weights are rounded to.
template <class Of>
PoseMoments mixture_of_moments(std::span<const double> weights, std::size_t reference,
                               const Of& of) {
  const PoseMoments& about = of(reference);
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    shift += weights[i] * boxminus(of(i).mean, about.mean);
  }
  const Pose mean{about.mean.x + shift(0), about.mean.y + shift(1),
                  wrap(about.mean.heading + shift(2))};
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), own = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Eigen::Vector3d away = boxminus(of(i).mean, mean);
    spread += weights[i] * (away * away.transpose());
    own += weights[i] * (of(i).covariance - about.covariance);
  }
  own = (about.covariance + own).eval();
  return {mean, own + spread};
}

}  // namespace montecarta
