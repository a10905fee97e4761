// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/relative/vehicle_in_frames.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>

namespace montecarta::filters {

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
