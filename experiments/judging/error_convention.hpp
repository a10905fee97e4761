// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/state_columns.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace montecarta::experiments {

/// Definition of the error that a covariance describes (STATISTICS 19), in the order of
/// kErrorConventions.
enum class ErrorConvention { world, body, right_invariant, left_invariant, world_body };

/// Name of a convention: "world", "body", "right-invariant", "left-invariant" or "world-body".
std::string name_of(ErrorConvention convention);
/// Name of the column with the NEES under a convention: "nees_world", ...
std::string nees_column(ErrorConvention convention);
/// The conventions that a state may have: all for a pose in space, all but `world_body` for a pose
/// in the plane, where that is `world`, and only `world` for a vector.
std::span<const ErrorConvention> conventions_of(StateKind kind);

/// The convention that the user gave, or the only one that the state may have. `path` is the
/// file of the estimates. Throws StudyError if none was given and there are several.
ErrorConvention stated_error(const StateShape& shape, const std::filesystem::path& path,
                             std::optional<ErrorConvention> said);

/// The error {d} of an estimate under a convention that its state may have. `mean` and `truth` are
/// in the order of StateShape::columns.
Eigen::VectorXd error_of(const StateShape& shape, ErrorConvention convention,
                         const Eigen::VectorXd& mean, const Eigen::VectorXd& truth);

/// Converts the covariance of a planar pose under a convention to that of (x, y, heading) in the
/// map frame [m, m, rad], to first order.
Eigen::Matrix3d covariance_in_map(ErrorConvention convention, const Eigen::Vector3d& mean,
                                  const Eigen::Matrix3d& covariance);

}  // namespace montecarta::experiments
