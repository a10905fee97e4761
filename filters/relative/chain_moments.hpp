// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/relative/relative_chain.hpp"

#include <Eigen/Core>

#include <span>

namespace montecarta::filters {

/// Mean and covariance, in the map frame, of the vehicle's pose and then of `points`, of a Gaussian
/// (`mean`, `P`) over a relative chain (EQUATIONS (22.6)). Exact, the heading unwrapped: a place is
/// a sum of displacements, each turned by a sum of headings, and all of these are Gaussian
/// together.
JointEstimate chain_moments(const RelativeChain& chain, const Eigen::VectorXd& mean,
                            const Eigen::MatrixXd& P, std::span<const RelativeChain::Point> points);

}  // namespace montecarta::filters
