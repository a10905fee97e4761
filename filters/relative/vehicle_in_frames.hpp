// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/eigen_jacobians.hpp"
#include "filters/relative/relative_chain.hpp"

#include <Eigen/Core>

#include <vector>

namespace montecarta::filters {

/// Pairs of quantities, linearised in a relative chain: each depends on points and on the pose of
/// the vehicle in their frames.
struct LinearisedPairs {
  struct Part {
    Eigen::Index pair;  ///< that it adds to
    std::size_t frame;
    Eigen::Index row;  ///< of the point
    Matrix23 by_pose;
    Eigen::Matrix2d by_point;  ///< by its coordinates
  };
  Eigen::VectorXd residual;  ///< {2 pairs} measured less expected
  std::vector<Part> parts;   ///< newest frame first
};

/// The vehicle's pose in each frame from some frame on (EQUATIONS (22.2)), and products with the
/// derivatives of LinearisedPairs, H. One walk from the newest frame back to the oldest gives each:
/// H itself has three columns for each frame on the way.
class VehicleInFrames {
 public:
  /// At `mean`, back to frame `oldest`.
  void linearise(const RelativeChain& chain, const Eigen::VectorXd& mean, std::size_t oldest);
  const Pose& in(std::size_t frame) const { return steps_[frame].pose; }

  /// PH <- P H'.
  void columns(const RelativeChain& chain, const Eigen::MatrixXd& P, const LinearisedPairs& pairs,
               Eigen::MatrixXd& PH) const;
  /// H M.
  Eigen::MatrixXd rows(const RelativeChain& chain, const LinearisedPairs& pairs,
                       const Eigen::Ref<const Eigen::MatrixXd>& M) const;

 private:
  std::vector<LinearisedComposition> steps_;  ///< {frame} pose: of the vehicle
};

/// The vehicle's pose in one frame after the other, newest first, as a Gaussian: for what is asked
/// of all frames.
struct VehicleGaussian {
  Pose pose = {};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, Eigen::Dynamic, 3> with_all;  ///< covariance of all rows with the pose

  /// From that in frame k + 1, or the vehicle's own, for which all is zero.
  void become_that_in_frame(std::size_t k, const RelativeChain& chain, const Eigen::VectorXd& mean,
                            const Eigen::MatrixXd& P);
};

}  // namespace montecarta::filters
