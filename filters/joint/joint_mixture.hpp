// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/slam_filter.hpp"

namespace montecarta {

/// Adds up joint Gaussians to the mean and covariance of their mixture, as differences from one of
/// them: components that are all equal give exactly their own moments, whatever their weights are
/// rounded to. NaN of landmarks never seen stays NaN.
class JointMixture {
 public:
  explicit JointMixture(JointEstimate about);

  /// A component of weight `weight`; the weights of all are to add up to one. The one it is about
  /// needs not be added.
  void add(double weight, const JointEstimate& component);
  JointEstimate result() const;

 private:
  JointEstimate about_;
  Eigen::VectorXd shift_;
  Eigen::MatrixXd change_;
};

}  // namespace montecarta
