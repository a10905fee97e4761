// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_columns.hpp"

#include <Eigen/Core>

#include <span>
#include <string>

namespace montecarta::experiments {

/// What error a covariance is the covariance of (STATISTICS 19), in the order of kErrorConventions.
enum class ErrorConvention { world, body, right_invariant };

/// "world", "body", "right-invariant".
std::string name_of(ErrorConvention convention);
/// Name of the column with the NEES by it: "nees_world", ...
std::string nees_column(ErrorConvention convention);
/// Those that a state has: all of a pose, of a vector `world` alone.
std::span<const ErrorConvention> conventions_of(StateKind kind);

/// What each convention is, for whoever did not say one.
std::string explained_conventions();

/// The error {d} of an estimate by a convention that its state has. Both in the order of
/// StateShape::columns.
Eigen::VectorXd error_of(const StateShape& shape, ErrorConvention convention,
                         const Eigen::VectorXd& mean, const Eigen::VectorXd& truth);

/// The covariance of a pose in the plane, given by a convention, as one of (x, y, heading) in the
/// frame of the map [m, m, rad], to first order.
Eigen::Matrix3d covariance_in_map(ErrorConvention convention, const Eigen::Vector3d& mean,
                                  const Eigen::Matrix3d& covariance);

}  // namespace montecarta::experiments
