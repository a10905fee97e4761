// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/eigen_jacobians.hpp"
#include "filters/relative/relative_chain.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
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

/// What a relative Gaussian is conditioned on, all at once.
struct RelativeMeasurement {
  /// Of all frames that it tells of.
  std::size_t oldest_frame;
  /// Linearises at a mean, where the vehicle is as told; false where there are no derivatives.
  std::function<bool(const Eigen::VectorXd& mean, const VehicleInFrames& vehicle,
                     LinearisedPairs& pairs)>
      linearise;
  /// Of the measured quantities; empty where they are exact.
  Eigen::VectorXd variances;
};

/// What became of it.
struct RelativeOutcome {
  bool is_faulty = false;  ///< nothing was changed
  double nis = 0.0;        ///< against the Gaussian before
  std::uint32_t dof = 0;
  double log_likelihood = 0.0;  ///< Laplace's, at the last linearisation
};

/// What one conditioning leaves to the next, so that none allocates.
struct ConditioningScratch {
  VehicleInFrames vehicle, tried_vehicle;
  LinearisedPairs pairs, tried_pairs;
};

/// Conditions (`mean`, `P`) on `measurement` by the Gauss-Newton method, at most `iterations` more
/// linearisations than one; a step is halved while the sum of squares rises, eight times at most
/// (EQUATIONS (22.3)). Rows of P are a multiple of eight, those that are not used zero.
RelativeOutcome condition(const RelativeChain& chain, const RelativeMeasurement& measurement,
                          int iterations, ConditioningScratch& scratch, Eigen::VectorXd& mean,
                          Eigen::MatrixXd& P);

}  // namespace montecarta::filters
