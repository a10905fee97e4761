// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/models/eigen_jacobians.hpp"
#include "filters/relative/relative_chain.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <vector>

namespace montecarta::filters {

/// Pairs of measured quantities, linearised in a relative chain: each depends on points and on the
/// pose of the vehicle in their frames.
struct LinearisedPairs {
  struct Part {
    Eigen::Index pair;  ///< pair to which it adds
    std::size_t frame;
    Eigen::Index row;  ///< first row of the point
    Matrix23 by_pose;
    Eigen::Matrix2d by_point;  ///< derivative by its coordinates
  };
  Eigen::VectorXd residual;  ///< {2 pairs} measured minus predicted
  std::vector<Part> parts;   ///< parts, those of the newest frame first
};

/// The pose of the vehicle in each frame (EQUATIONS (22.2)), and products with H, the derivatives
/// of LinearisedPairs. Each product takes one pass from the newest frame back to the oldest,
/// whereas H itself would have three columns for each frame on the way.
class VehicleInFrames {
 public:
  /// Linearises at `mean`, back to frame `oldest`.
  void linearise(const RelativeChain& chain, const Eigen::VectorXd& mean, std::size_t oldest);
  const Pose& in(std::size_t frame) const { return steps_[frame].pose; }

  /// Computes PH = P H'.
  void columns(const RelativeChain& chain, const Eigen::MatrixXd& P, const LinearisedPairs& pairs,
               Eigen::MatrixXd& PH) const;
  /// Returns H M.
  Eigen::MatrixXd rows(const RelativeChain& chain, const LinearisedPairs& pairs,
                       const Eigen::Ref<const Eigen::MatrixXd>& M) const;

 private:
  /// {frame} composition with the pose of the vehicle in the frame.
  std::vector<LinearisedComposition> steps_;
};

/// The pose of the vehicle in one frame after the other, newest first, as a Gaussian.
struct VehicleGaussian {
  Pose pose = {};
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, Eigen::Dynamic, 3> with_all;  ///< covariance of all rows with the pose

  /// Changes from frame k + 1 to frame k. Initially, all zero, it is the vehicle in its own frame.
  void become_that_in_frame(std::size_t k, const RelativeChain& chain, const Eigen::VectorXd& mean,
                            const Eigen::MatrixXd& P);
};

/// Measurements that a relative Gaussian is conditioned on together.
struct RelativeMeasurement {
  /// The oldest frame that they involve.
  std::size_t oldest_frame;
  /// Linearises at a mean with the given poses of the vehicle; false if there is no derivative.
  std::function<bool(const Eigen::VectorXd& mean, const VehicleInFrames& vehicle,
                     LinearisedPairs& pairs)>
      linearise;
  /// Variances of the measured quantities; empty if they are exact.
  Eigen::VectorXd variances;
};

/// The result of conditioning.
struct RelativeOutcome {
  bool is_faulty = false;  ///< if true, nothing was changed
  double nis = 0.0;        ///< NIS by the Gaussian before conditioning
  std::uint32_t dof = 0;
  double log_likelihood = 0.0;  ///< Laplace's approximation, at the last linearisation
};

/// Memory that is reused from one conditioning to the next.
struct ConditioningScratch {
  VehicleInFrames vehicle, tried_vehicle;
  LinearisedPairs pairs, tried_pairs;
};

/// Conditions (`mean`, `P`) on `measurement` by the Gauss-Newton method, with at most `iterations`
/// linearisations after the first. A step is halved while the sum of squares rises, at most eight
/// times (EQUATIONS (22.3)). Rows of P must be a multiple of eight, with zeros in unused ones.
RelativeOutcome condition(const RelativeChain& chain, const RelativeMeasurement& measurement,
                          int iterations, ConditioningScratch& scratch, Eigen::VectorXd& mean,
                          Eigen::MatrixXd& P);

}  // namespace montecarta::filters
