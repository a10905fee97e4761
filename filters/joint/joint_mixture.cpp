// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_mixture.hpp"

#include "engine/numbers/angle.hpp"

#include <utility>

namespace montecarta {

JointMixture::JointMixture(JointEstimate about)
    : about_(std::move(about)),
      shift_(Eigen::VectorXd::Zero(about_.mean.size())),
      change_(Eigen::MatrixXd::Zero(about_.mean.size(), about_.mean.size())) {}

void JointMixture::add(double weight, const JointEstimate& component) {
  Eigen::VectorXd away = component.mean - about_.mean;
  away(2) = wrap(away(2));
  shift_ += weight * away;
  change_ += weight * (component.covariance - about_.covariance + away * away.transpose());
}

JointEstimate JointMixture::result() const {
  JointEstimate mixture{about_.mean + shift_,
                        about_.covariance + change_ - shift_ * shift_.transpose()};
  mixture.mean(2) = wrap(mixture.mean(2));
  return mixture;
}

}  // namespace montecarta
